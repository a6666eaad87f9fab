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

  const first = sides.find((side) => !side.stands);
  const clock = makeClock();
  const alignments = [byTime(sides), byShare(sides)].filter(Boolean).map((alignment) => {
    const { duration, placeOf } = alignment;
    const spans = first.spans.map(([name, ...ends]) =>
      [name, ...ends.map((time) => Math.max(0, Math.min(duration, placeOf(first, time))))]);
    const panel = at(`plots-${alignment.name}`);
    const plots = makePlots(clock, { ...alignment, spans, start: 0 }, alignedSamples(sides, alignment), panel);
    return { ...alignment, panel, plots: groupedPlots(plots, sides) };
  });
  let now = alignments[0];
  let over = false;

  const transport = makeTransport(clock, { speeds: data.speeds, rate: data.rate, said: (x) => now.said(x) }, at);
  clock.onTime(show);
  for (const { plots } of alignments) plots.choose(data.plotted);
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
  }

  function where(side, x) {
    if (side.stands) return "stands";
    const time = now.timeOf(side, x);
    if (time > side.duration + 1e-9) return "has ended";
    const [name] = side.spans.filter((span) => span[1] <= time).pop() || side.spans[0];
    return `${(side.start + time).toFixed(3)} s, ${name}`;
  }

  function align(name) {
    const [before, next] = [now, alignments.find((each) => each.name === name)];
    if (!next) return;
    const here = (x) => (before === next ? x : next.placeOf(first, before.timeOf(first, x)));
    const [x, loop] = [here(clock.time), clock.loop && clock.loop.map(here)];
    now = next;
    clock.setMotion(now);
    clock.setLoop(loop);
    for (const each of alignments) {
      each.panel.hidden = each !== now;
      each.plots.draw();
    }
    at("over").textContent = now.title;
    press("aligned", name);
    drawPhases();
    clock.seek(x);
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
    show(clock.time);
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

  const views = shown.length ? shown[0].camera.views : [];
  for (const view of views) at("view").append(new Option(view, view));
  at("view").addEventListener("change", () => setView(at("view").value));
  at("aligned").addEventListener("click", ({ target }) => target.value && align(target.value));
  at("placed").addEventListener("click", ({ target }) => target.value && place(target.value === "over"));
  if (alignments.length < 2) Object.assign(at("aligned").lastElementChild, { disabled: true, title: "some motion has no whole cycle" });
  if (!shown.some((side) => side.ghost)) Object.assign(at("placed").lastElementChild, { disabled: true, title: "the robots are different" });
  makeKeys([
    ...transport.keys,
    { keys: ["s"], label: "by time, by share of the cycle", act: () => align(now.name === "time" ? "share" : "time") },
    { keys: ["g"], label: "side by side, ghosts", act: () => place(!over) },
    ...views.map((view, i) => ({ keys: [String(i + 1)], label: `view: ${view}`, act: () => setView(view) })),
  ], at);

  Object.defineProperties(window.player, Object.getOwnPropertyDescriptors({
    align, clock, place, setView,
    setSpeed: clock.setSpeed,
    get alignment() { return now.name; },
    get over() { return over; },
    get plots() { return now.plots; },
  }));
  align("time");
  place(false);
  setView("side");
  const { time, playing } = begins();
  clock.seek(time ?? 0);
  clock.setPlaying(playing);
})();
