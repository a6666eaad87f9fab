// the page: its parts, put together

(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const viewer = openViewer(at("pane"), data.commands, data);
  if (data.ghost) addGhost(viewer, data.ghost);
  paintScene(viewer, data);

  const samples = readSamples(data.samples);
  addPictures(samples, data);
  const clock = makeClock(data.duration);
  const camera = makeCamera(viewer, at("pane"), data);
  clock.onTime((time) => {
    viewer.animator.seek(time);
    camera.onTime();
  });
  const labels = makeLabels(viewer, at("pane"), at("labels"), data, samples);
  clock.onTime((time) => (labels.time = time));
  const timeline = makeTimeline(clock, at);
  timeline.show(data);
  const transport = makeTransport(clock, { speeds: data.speeds, rate: data.rate, said: timeline.said }, at);
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
    { name: "tracks", key: "k", label: "Tracks", title: "Way of the torso and footprints on the ground", on: true,
      apply: visible(data.tracks), when: data.tracks.length },
    { name: "follow", key: "f", label: "Follow", title: "The camera follows the body", on: true,
      apply: (on) => camera.hold(on ? null : camera.here()), when: data.follows },
    { name: "turn", key: "h", label: "Turn", title: "The camera turns with the body's heading", on: true,
      apply: camera.turn, when: data.turns },
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
  plots.choose([FEET, PLAN, ...data.samples.plotted]);
  makeColumnList(samples, plots, at("columnlist"));
  plots.onChange(() => (chosen = true));

  function reset() {
    switches.set("turn", true);
    switches.set("follow", true);
    camera.reset();
  }

  buildControls();
  makeKeys([
    ...transport.keys,
    ...timeline.keys,
    ...camera.views.map((view, i) => ({ keys: [String(i + 1)], label: `view: ${view}`, act: () => camera.setView(view) })),
    { keys: ["r"], label: "the view as at first", act: reset },
    ...switches.all.map(({ name, key, title }) => ({ keys: [key], label: title.toLowerCase() + ", on or off",
      act: () => switches.toggle(name) })),
  ], at);

  const address = makeAddress({
    clock, camera, plots, switches,
    columnsChosen: () => chosen,
    chooseColumns: plots.choose,
  }, data.start);

  function buildControls() {
    for (const view of camera.views) at("view").append(new Option(view, view));
    at("view").append(new Option("by hand", ""));
    at("view").lastChild.disabled = true;
    at("view").addEventListener("change", () => camera.setView(at("view").value));
    camera.onChange(() => (at("view").value = camera.state.view || ""));
    const clicks = {
      reset,
      csv: () => saveSamples(samples, data),
      png: () => savePicture(viewer, data, clock.time),
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
