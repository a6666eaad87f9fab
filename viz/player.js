// the page: its parts, put together

(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const viewer = openViewer(at("pane"), data.commands, data);
  if (data.ghost) addGhost(viewer, data.ghost);
  paintScene(viewer, data);

  const samples = readSamples(data.samples);
  const clock = makeClock(data.duration);
  const camera = makeCamera(viewer, at("pane"), data);
  clock.onTime((time) => {
    viewer.animator.seek(time);
    camera.onTime();
  });
  const labels = makeLabels(viewer, at("pane"), at("labels"), data, samples);
  clock.onTime((time) => (labels.time = time));
  const timeline = makeTimeline(clock, data, at);
  const plots = makePlots(clock, data, samples, at("plots"));

  const visible = (paths) => (on) => {
    for (const path of paths) nodeAt(viewer, path).object.visible = on;
    viewer.set_dirty();
  };
  const roomy = innerWidth >= 1000 && innerHeight >= 620;
  const switches = makeSwitches(at("switches"), [
    { name: "plots", key: "p", label: "Plots", title: "Plots of the samples over time", on: roomy, apply: showPlots },
    { name: "forces", key: "n", label: "Forces", title: "Numbers at the ground forces", on: false,
      apply: (on) => labels.show("forces", on), when: data.arrows.some(([, toe]) => samples.byName.has(`force_z_${toe}`)) },
    { name: "angles", key: "a", label: "Angles", title: "Angles of the joints", on: false,
      apply: (on) => labels.show("angles", on), when: data.joints.length },
    { name: "trails", key: "t", label: "Paths", title: "Paths of the toes", on: true, apply: visible(data.trails),
      when: data.trails.length },
    { name: "arrows", key: "o", label: "Arrows", title: "Arrows of the ground forces", on: true,
      apply: visible(data.arrows.flatMap(([path]) => [`${path}/shaft`, `${path}/head`])), when: data.arrows.length },
    { name: "ghost", key: "g", label: "Ghost", title: "The other motion",
      on: true, apply: (on) => visible(data.ghost ? ghostParts() : [])(on), when: data.ghost },
    { name: "follow", key: "f", label: "Follow", title: "The camera follows the body", on: true,
      apply: (on) => camera.hold(on ? null : camera.here()), when: data.follows },
  ].filter(({ when = true }) => when));

  // whether the ghost itself shows is a matter of time
  function ghostParts() {
    return Object.keys(nodeAt(viewer, data.ghost.path).children).map((name) => `${data.ghost.path}/${name}`);
  }

  function showPlots(on) {
    at("plots").hidden = at("columns").hidden = !on;
    plots.draw();
  }

  let chosen = false; // by the reader
  plots.choose(data.samples.plotted);
  makeColumnList(samples, plots, at("columnlist"));
  plots.onChange(() => (chosen = true));

  function step(way) {
    clock.pauseAt(clock.time + way / data.rate);
  }

  function nextSpeed(way) {
    const faster = [...data.speeds].sort((a, b) => a - b);
    const here = faster.findIndex((speed) => speed >= clock.speed - 1e-9);
    clock.setSpeed(faster[Math.max(0, Math.min(faster.length - 1, here + way))]);
  }

  function bound(end) {
    const loop = clock.loop || [0, data.duration];
    clock.setLoop(end === "begin" ? [clock.time, loop[1]] : [loop[0], clock.time]);
  }

  function reset() {
    switches.set("follow", true);
    camera.reset();
  }

  buildControls();
  makeKeys([
    { keys: [" "], label: "play, pause", act: () => clock.setPlaying(!clock.playing) },
    { keys: [",", "ArrowLeft"], label: "one frame back", act: step },
    { keys: [".", "ArrowRight"], label: "one frame on", act: step },
    { keys: ["Shift+ArrowLeft", "Shift+ArrowRight"], label: "to the event before, after",
      act: (way) => clock.pauseAt(timeline.beside(clock.time, way)) },
    { keys: ["Home"], label: "to the beginning", act: () => clock.seek(0) },
    { keys: ["End"], label: "to the end", act: () => clock.pauseAt(data.duration) },
    { keys: ["-"], label: "slower", act: () => nextSpeed(-1) },
    { keys: ["+", "="], label: "faster", act: () => nextSpeed(1) },
    { keys: ["["], label: "a loop begins here", act: () => bound("begin") },
    { keys: ["]"], label: "a loop ends here", act: () => bound("end") },
    { keys: ["l"], label: "no loop", act: () => clock.setLoop(null) },
    ...camera.views.map((view, i) => ({ keys: [String(i + 1)], label: `view: ${view}`, act: () => camera.setView(view) })),
    { keys: ["r"], label: "the view as at first", act: reset },
    ...switches.all.map(({ name, key, title }) => ({ keys: [key], label: title.toLowerCase() + ", on or off",
      act: () => switches.toggle(name) })),
    { keys: ["?"], label: "this list", act: () => at("help").showModal() },
  ], at("help"), at("keylist"));

  const address = makeAddress({
    clock, camera, plots, switches,
    columnsChosen: () => chosen,
    chooseColumns: plots.choose,
  }, data.start);

  function buildControls() {
    for (const speed of data.speeds) {
      const button = document.createElement("button");
      button.type = "button";
      button.value = speed;
      button.textContent = speed + "×";
      button.addEventListener("click", () => clock.setSpeed(speed));
      at("speeds").append(button);
    }
    for (const view of camera.views) at("view").append(new Option(view, view));
    at("view").append(new Option("by hand", ""));
    at("view").lastChild.disabled = true;
    at("view").addEventListener("change", () => camera.setView(at("view").value));
    camera.onChange(() => (at("view").value = camera.state.view || ""));
    clock.onChange(() => {
      at("play").classList.toggle("playing", clock.playing);
      at("play").setAttribute("aria-label", clock.playing ? "Pause" : "Play");
      for (const button of at("speeds").children)
        button.setAttribute("aria-pressed", Number(button.value) === clock.speed);
      at("noloop").hidden = !clock.loop;
    });
    const clicks = {
      play: () => clock.setPlaying(!clock.playing),
      back: () => step(-1),
      on: () => step(1),
      noloop: () => clock.setLoop(null),
      reset,
      csv: () => saveSamples(samples, data),
      png: () => savePicture(viewer, data, clock.time),
      keys: () => at("help").showModal(),
      more: () => {
        const open = document.body.classList.toggle("more");
        at("more").setAttribute("aria-expanded", open);
      },
    };
    for (const [id, act] of Object.entries(clicks)) at(id).addEventListener("click", act);
    const columns = at("columns");
    addEventListener("pointerdown", ({ target }) => columns.contains(target) || (columns.open = false));
    columns.addEventListener("keydown", ({ key }) => {
      if (key !== "Escape") return;
      columns.open = false;
      columns.firstElementChild.focus();
    });
    at("legendbox").open = innerHeight >= 420 && innerWidth >= (window.parent === window ? 700 : 1000);
    for (const [text, color] of [...data.legend, ...(data.ghost ? [["the other motion", "#8a97a3"]] : [])]) {
      const item = document.createElement("li");
      const swatch = document.createElement("i");
      swatch.style.background = color;
      item.append(swatch, text);
      at("legend").append(item);
    }
    for (const note of data.notes) {
      const item = document.createElement("li");
      item.textContent = note;
      at("notes").append(item);
    }
    if (data.samples.every > 1) at("csv").title += `; one of ${data.samples.every} samples is in this page`;
  }

  window.player = {
    viewer, clock, camera, plots, switches, samples, address,
    get time() { return clock.time; },
    get playing() { return clock.playing; },
    get speed() { return clock.speed; },
    seek: clock.seek,
    setPlaying: clock.setPlaying,
    setSpeed: clock.setSpeed,
  };
})();
