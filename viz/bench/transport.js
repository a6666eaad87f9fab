// how the time is played, on every page the same: button, scrubber, speeds, loop, keys

// `speeds` to choose from, `rate` frames a second, `said(time)` a time in words; gives `keys` for `makeKeys`
function makeTransport(clock, { speeds, rate, said }, at) {
  const scrubber = at("scrubber");
  const toggle = () => clock.setPlaying(!clock.playing);
  const step = (way) => clock.pauseAt(clock.time + (way * clock.rate) / rate);
  const unbound = () => clock.setLoop(null);

  function nextSpeed(way) {
    const faster = [...speeds].sort((a, b) => a - b);
    const here = faster.findIndex((speed) => speed >= clock.speed - 1e-9);
    clock.setSpeed(faster[Math.max(0, Math.min(faster.length - 1, here + way))]);
  }

  function bound(end) {
    const loop = clock.loop || [0, clock.duration];
    clock.setLoop(end === "begin" ? [clock.time, loop[1]] : [loop[0], clock.time]);
  }

  for (const speed of speeds) {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", value: speed, textContent: `${speed}×` });
    button.addEventListener("click", () => clock.setSpeed(speed));
    at("speeds").append(button);
  }
  scrubber.addEventListener("input", () => clock.pauseAt(Number(scrubber.value)));
  const clicks = { play: toggle, before: () => step(-1), after: () => step(1), noloop: unbound };
  for (const [id, act] of Object.entries(clicks)) at(id)?.addEventListener("click", act);

  function show(time) {
    scrubber.value = time;
    if (!clock.playing) scrubber.setAttribute("aria-valuetext", said(time));
  }

  clock.onTime(show);
  clock.onChange(() => {
    scrubber.max = clock.duration;
    show(clock.time);
    at("play").classList.toggle("playing", clock.playing);
    at("play").setAttribute("aria-label", clock.playing ? "Pause" : "Play");
    for (const button of at("speeds").children)
      button.setAttribute("aria-pressed", Number(button.value) === clock.speed);
    if (at("noloop")) at("noloop").hidden = !clock.loop;
  });

  return { keys: [
    { keys: [" "], label: "play, pause", act: toggle },
    { keys: [",", "ArrowLeft"], label: "one frame back", act: step },
    { keys: [".", "ArrowRight"], label: "one frame on", act: step },
    { keys: ["Home"], label: "to the beginning", act: () => clock.seek(0) },
    { keys: ["End"], label: "to the end", act: () => clock.pauseAt(clock.duration) },
    { keys: ["-"], label: "slower", act: () => nextSpeed(-1) },
    { keys: ["+", "="], label: "faster", act: () => nextSpeed(1) },
    { keys: ["["], label: "a loop begins here", act: () => bound("begin") },
    { keys: ["]"], label: "a loop ends here", act: () => bound("end") },
    { keys: ["l"], label: "no loop", act: unbound },
  ] };
}

// where a page begins: at the time that its address names, paused, or playing unless the reader wants no motion
function begins() {
  const named = Number.parseFloat(new URLSearchParams(location.hash.slice(1)).get("t"));
  const given = Number.isFinite(named);
  return { time: given ? named : null, playing: !given && !matchMedia("(prefers-reduced-motion: reduce)").matches };
}
