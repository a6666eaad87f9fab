// the time of the motion, from its start, and how it passes; in s, or in units of which `rate` pass in a second

// time passes where `ready()`, too
function makeClock(duration = 0, ready = () => true) {
  const seen = [];
  const changed = [];
  const clock = { time: 0, duration, rate: 1, speed: 1, playing: false, loop: null };
  let hold = 0;
  let held = 0; // of it
  const tell = () => changed.forEach((listener) => listener(clock));
  const within = (time) => Math.max(0, Math.min(clock.duration, time));

  clock.onTime = (listener) => seen.push(listener);
  clock.onChange = (listener) => changed.push(listener); // of all but the time that passes

  function show(time) {
    clock.time = within(time);
    for (const listener of seen) listener(clock.time);
  }

  clock.seek = function (time) {
    held = 0;
    show(time);
    tell();
  };

  clock.setPlaying = function (playing) {
    clock.playing = playing;
    tell();
  };

  clock.setSpeed = function (speed) {
    clock.speed = speed;
    tell();
  };

  // a pair of times that playing goes round between, or null
  clock.setLoop = function (loop) {
    const [begin, end] = (loop || [0, 0]).map(within);
    clock.loop = end > begin ? [begin, end] : null;
    tell();
  };

  // another motion, that holds at its end before it begins anew; who asks for it says what time it is there
  clock.setMotion = function (motion) {
    Object.assign(clock, { duration: motion.duration, rate: motion.rate ?? 1 });
    hold = motion.hold ?? 0;
    clock.setLoop(clock.loop);
  };

  clock.pauseAt = function (time) {
    clock.playing = false;
    clock.seek(time);
  };

  clock.pass = function (seconds) {
    const [begin, end] = clock.loop || [0, clock.duration];
    const whole = end - begin + (clock.loop ? 0 : hold);
    const past = Math.max(0, clock.time + held + seconds * clock.rate - begin) % whole;
    held = Math.max(0, begin + past - end);
    show(begin + past - held);
  };

  let last = performance.now();
  (function tick(now) {
    const passed = Math.min(0.1, Math.max(0, (now - last) / 1000)) * clock.speed;
    last = now;
    if (clock.playing && ready()) clock.pass(passed);
    requestAnimationFrame(tick);
  })(last);
  return clock;
}
