// the page of a comparison: viewers that go together, plots of all, keys

(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const figures = [...document.querySelectorAll(".motion")];
  const sides = data.sides.map((side, number) => ({ ...side, number, samples: readSamples(side.samples) }));
  const shown = sides.map(openSide).filter(Boolean);
  window.player = { sides, shown };
  shareCamera();
  if (!at("controls")) return; // nothing moves

  const alignments = [byTime(sides), byShare(sides)].filter(Boolean).map((alignment) => {
    const clock = makeClock(alignment.duration);
    const panel = at(`plots-${alignment.name}`);
    const first = sides.find((side) => !side.stands);
    const spans = first.spans.map(([name, begin, end]) => [name, ...[begin, end].map((time) =>
      Math.max(0, Math.min(alignment.duration, alignment.placeOf(first, time))))]);
    const plots = groupedPlots(
      makePlots(clock, { ...alignment, spans, start: 0 }, alignedSamples(sides, alignment), panel), sides);
    return { ...alignment, clock, panel, plots };
  });
  let now = alignments[0];
  let factor = 1; // of real time
  let over = false;

  for (const alignment of alignments) {
    const { clock, plots } = alignment;
    clock.onTime((x) => alignment === now && show(x));
    clock.onChange(() => alignment === now && told());
    plots.choose(data.plotted);
  }
  const listed = [...new Map(sides.flatMap((side) => side.samples.columns).map((column) => [column.name, column])).values()];
  makeColumnList({ columns: listed }, {
    names: () => now.plots.names(),
    choose: (names) => alignments.forEach(({ plots }) => plots.choose(names)),
    onChange: (listener) => alignments.forEach(({ plots }) => plots.onChange(listener)),
  }, at("columnlist"));

  function openSide(side) {
    const figure = figures[side.number];
    const pane = figure.querySelector(".pane");
    try {
      const viewer = openViewer(pane, side.commands, side);
      if (side.ghost) addGhost(viewer, side.ghost);
      paintScene(viewer, side);
      const made = { ...side, figure, pane, viewer, camera: makeCamera(viewer, pane, side), haunting: haunting(viewer, side) };
      haunt(made, false);
      return made;
    } catch (problem) {
      console.warn(String(problem)); // tables and plots need no WebGL
      return null;
    }
  }

  // actions of the ghost, which has a time of its own
  function haunting(viewer, { ghost }) {
    if (!ghost) return new Set();
    const { object } = nodeAt(viewer, ghost.path);
    const below = (node) => node && (node === object || below(node.parent));
    return new Set(viewer.animator.actions.filter((action) => below(action.getRoot())));
  }

  function haunt(side, on) {
    if (!side.ghost) return;
    for (const node of Object.values(nodeAt(side.viewer, side.ghost.path).children)) node.object.visible = on;
    side.figure.querySelector(".with").hidden = !on;
    side.viewer.set_dirty();
  }

  function show(x) {
    const ghostTime = now.timeOf(sides[0], x);
    for (const side of shown) {
      if (side.figure.hidden) continue;
      const time = now.timeOf(side, x);
      for (const action of side.viewer.animator.actions) {
        const own = side.haunting.has(action) ? ghostTime : Math.min(time, side.duration);
        action.time = Math.max(0, Math.min(action.getClip().duration, own));
      }
      side.viewer.animator.mixer.update(0);
      side.camera.onTime();
      side.viewer.set_dirty();
    }
    for (const side of sides) figures[side.number].querySelector(".where").textContent = where(side, x);
    at("now").textContent = now.said(x);
    at("cursor").style.left = `${(100 * x) / now.duration}%`;
    at("scrubber").value = x;
    if (!now.clock.playing) at("scrubber").setAttribute("aria-valuetext", now.said(x));
  }

  function where(side, x) {
    if (side.stands) return "stands";
    const time = now.timeOf(side, x);
    if (time > side.duration + 1e-9) return "has ended";
    const [name] = side.spans.filter((span) => span[1] <= time).pop() || side.spans[0];
    return `${(side.start + time).toFixed(3)} s, ${name}`;
  }

  function told() {
    at("play").classList.toggle("playing", now.clock.playing);
    at("play").setAttribute("aria-label", now.clock.playing ? "Pause" : "Play");
  }

  function align(name) {
    const [before, next] = [now, alignments.find((each) => each.name === name)];
    if (!next) return;
    const playing = before.clock.playing;
    const first = sides.find((side) => !side.stands);
    const time = before.timeOf(first, before.clock.time);
    before.clock.setPlaying(false);
    now = next;
    for (const each of alignments) {
      each.panel.hidden = each !== now;
      each.plots.draw();
    }
    at("over").textContent = now.title;
    at("scrubber").max = now.duration;
    press("aligned", name);
    drawPhases();
    setSpeed(factor);
    now.clock.seek(before === now ? now.clock.time : now.placeOf(first, time));
    now.clock.setPlaying(playing);
  }

  function drawPhases() {
    const percent = (side, time) => `${Math.max(0, Math.min(100, (100 * now.placeOf(side, time)) / now.duration))}%`;
    for (const row of document.querySelectorAll(".phases")) {
      const side = sides[row.dataset.side];
      const stops = side.spans.map(([name, begin, end]) => `${colorOf(name)} ${percent(side, begin)} ${percent(side, end)}`);
      const end = percent(side, side.duration);
      row.style.background = `linear-gradient(to right, ${stops.join(", ")}, transparent ${end})`;
    }
  }

  function place(ghosts) {
    over = ghosts && sides.some((side) => side.ghost);
    figures[0].hidden = over;
    for (const side of shown) haunt(side, over);
    at("motions").classList.toggle("over", over);
    press("placed", over ? "over" : "beside");
    show(now.clock.time);
  }

  function setSpeed(speed) {
    factor = speed;
    now.clock.setSpeed(speed * now.rate);
    press("speeds", String(speed));
  }

  function press(group, value) {
    for (const button of at(group).children) button.setAttribute("aria-pressed", button.value === value);
  }

  // what one camera does the others do, nearer or farther as their robots are smaller or larger
  function shareCamera() {
    let busy = false;
    for (const from of shown)
      from.viewer.controls.addEventListener("change", () => {
        if (busy) return;
        busy = true;
        for (const to of shown) {
          if (to === from) continue;
          const scale = to.distance / from.distance;
          to.viewer.camera.position.copy(from.viewer.camera.position).multiplyScalar(scale);
          to.viewer.controls.target.copy(from.viewer.controls.target).multiplyScalar(scale);
          to.viewer.controls.update();
          to.viewer.set_dirty();
        }
        busy = false;
      });
  }

  function setView(name) {
    for (const side of shown) side.camera.setView(name);
    at("view").value = name;
  }

  const step = (way) => now.clock.pauseAt(now.clock.time + (way * now.rate) / data.rate);
  const nextSpeed = (way) => {
    const faster = [...data.speeds].sort((a, b) => a - b);
    setSpeed(faster[Math.max(0, Math.min(faster.length - 1, faster.indexOf(factor) + way))]);
  };
  const bound = (end) => {
    const loop = now.clock.loop || [0, now.duration];
    now.clock.setLoop(end === "begin" ? [now.clock.time, loop[1]] : [loop[0], now.clock.time]);
  };

  for (const speed of data.speeds) {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", value: speed, textContent: `${speed}×` });
    button.addEventListener("click", () => setSpeed(speed));
    at("speeds").append(button);
  }
  const views = shown.length ? shown[0].camera.views : [];
  for (const view of views) at("view").append(new Option(view, view));
  at("view").addEventListener("change", () => setView(at("view").value));
  at("play").addEventListener("click", () => now.clock.setPlaying(!now.clock.playing));
  at("scrubber").addEventListener("input", () => now.clock.pauseAt(Number(at("scrubber").value)));
  at("aligned").addEventListener("click", ({ target }) => target.value && align(target.value));
  at("placed").addEventListener("click", ({ target }) => target.value && place(target.value === "over"));
  at("keys").addEventListener("click", () => at("help").showModal());
  if (alignments.length < 2) Object.assign(at("aligned").lastElementChild, { disabled: true, title: "some motion has no whole cycle" });
  if (!shown.some((side) => side.ghost)) Object.assign(at("placed").lastElementChild, { disabled: true, title: "the robots are different" });
  makeKeys([
    { keys: [" "], label: "play, pause", act: () => now.clock.setPlaying(!now.clock.playing) },
    { keys: [",", "ArrowLeft"], label: "one frame back", act: step },
    { keys: [".", "ArrowRight"], label: "one frame on", act: step },
    { keys: ["Home"], label: "to the beginning", act: () => now.clock.seek(0) },
    { keys: ["End"], label: "to the end", act: () => now.clock.pauseAt(now.duration) },
    { keys: ["-"], label: "slower", act: () => nextSpeed(-1) },
    { keys: ["+", "="], label: "faster", act: () => nextSpeed(1) },
    { keys: ["["], label: "a loop begins here", act: () => bound("begin") },
    { keys: ["]"], label: "a loop ends here", act: () => bound("end") },
    { keys: ["l"], label: "no loop", act: () => now.clock.setLoop(null) },
    { keys: ["s"], label: "by time, by share of the cycle", act: () => align(now.name === "time" ? "share" : "time") },
    { keys: ["g"], label: "side by side, ghosts", act: () => place(!over) },
    ...views.map((view, i) => ({ keys: [String(i + 1)], label: `view: ${view}`, act: () => setView(view) })),
    { keys: ["?"], label: "this list", act: () => at("help").showModal() },
  ], at("help"), at("keylist"));

  Object.defineProperties(window.player, Object.getOwnPropertyDescriptors({
    align, place, setSpeed, setView,
    get clock() { return now.clock; },
    get alignment() { return now.name; },
    get over() { return over; },
    get plots() { return now.plots; },
  }));
  align("time");
  place(false);
  setView("side");
  const asked = Number.parseFloat(new URLSearchParams(location.hash.slice(1)).get("t"));
  now.clock.seek(Number.isFinite(asked) ? asked : 0);
  now.clock.setPlaying(!Number.isFinite(asked) && !matchMedia("(prefers-reduced-motion: reduce)").matches);
})();
