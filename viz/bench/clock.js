// the time of the motion, in s from its start, and how it passes

function makeClock(duration) {
  const seen = [];
  const changed = [];
  const clock = { time: 0, speed: 1, playing: false, loop: null };
  const tell = () => changed.forEach((listener) => listener(clock));

  clock.onTime = (listener) => seen.push(listener);
  clock.onChange = (listener) => changed.push(listener); // of all but the time that passes

  function show(time) {
    clock.time = Math.max(0, Math.min(duration, time));
    for (const listener of seen) listener(clock.time);
  }

  clock.seek = function (time) {
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
    const [begin, end] = (loop || [0, 0]).map((time) => Math.max(0, Math.min(duration, time)));
    clock.loop = end > begin ? [begin, end] : null;
    tell();
  };

  clock.pauseAt = function (time) {
    clock.playing = false;
    clock.seek(time);
  };

  clock.pass = function (seconds) {
    const [begin, end] = clock.loop || [0, duration];
    const past = clock.time + seconds - begin;
    show(past < 0 ? begin : begin + (past % (end - begin)));
  };

  let last = performance.now();
  (function tick(now) {
    const passed = Math.min(0.1, Math.max(0, (now - last) / 1000)) * clock.speed;
    last = now;
    if (clock.playing) clock.pass(passed);
    requestAnimationFrame(tick);
  })(last);
  return clock;
}
