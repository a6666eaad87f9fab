// the page: it asks its server what becomes of the numbers, and shows it

(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const VIEWS = { settled: "settled", transient: "first hops", cycle: "a cycle" };
  const REPEATS = ["periodic", "pattern"];
  const HOLD = 0.8; // s at the end of what does not repeat
  const LONG = 160; // letters: kinds with more are not told
  const PATIENCE = 1000; // ms between entries of the history
  const names = Object.keys(data.knobs);
  const defaults = Object.fromEntries(names.map((name) => [name, data.knobs[name].default]));
  const original = { ...data.default, name: "A, the default" };
  const state = { view: data.views[0], knobs: { ...defaults }, kept: false, hop: null, a: original };

  const viewer = openViewer(at("pane"), data.scene, data);
  paintScene(viewer, data);
  const camera = makeCamera(viewer, at("pane"), data);
  const questions = makeAsking(data, { heard, refused, lost: () => complain("No answer: has `spear explore` ended?") });
  const { ask } = questions;
  // frames of the old motion would hold up the new one
  const clock = makeClock(0, () => state.hop && !questions.idle());
  clock.onTime((time) => {
    viewer.animator.seek(time);
    camera.onTime();
  });
  const timeline = makeTimeline(clock, at);
  const transport = makeTransport(clock, { speeds: data.speeds, rate: data.rate, said: timeline.said }, at);
  const plots = makeComparison(data, at("plots"), clock);
  const readouts = makeReadouts(data.readouts, at("readouts"));
  const sliders = makeSliders(data.knobs, at("knobs"), {
    turn,
    enter,
    refuse: (name, text) => ask(query({ [name]: text })), // the answer says what is valid
    touch: (name) => tangents.over(name),
  });
  const tangents = makeTangents(data, questions, at);

  // what is shown

  let { time: named, playing } = begins();
  function show(hop, search) {
    const time = named ?? clock.time;
    [named, state.hop] = [null, hop];
    for (const path of data.overlays) viewer.handle_command({ type: "delete", path });
    handle(viewer, hop.commands);
    clock.setMotion({ duration: hop.duration, hold: REPEATS.includes(hop.verdict) ? 0 : HOLD });
    timeline.show({ ...hop, start: 0 });
    tangents.show(hop, search);
    compare();
    clock.seek(time % hop.duration);
  }

  function tell({ message, verdict, onward }) {
    at("verdict").textContent = onward ? "On the way there. " + message : message;
    at("verdict").className = verdict;
    outdate(verdict === "none");
  }

  // what is shown is not what the numbers on the sliders and in the fields say
  function outdate(stale, refused = false) {
    document.body.classList.toggle("stale", stale);
    document.body.classList.toggle("refused", refused);
  }

  // peaks may jump where another kind comes in
  function tellKind(other) {
    const another = other && other.kind && state.hop.kind && other.kind !== state.hop.kind;
    const which = !another || other.kind.length > LONG ? "" : `, which is: ${other.kind}`;
    at("kind").textContent = another ? `Of another kind than ${other.name}${which}.` : "";
  }

  const sameNumbers = (a, b) => names.every((name) => a[name] === b[name]);

  // B, what is shown, with A where that is another motion
  function compare() {
    const { a, hop } = state;
    const other = a !== original || !sameNumbers(a.knobs, hop.knobs) ? a : null;
    plots.show(other, hop);
    tangents.compare(a);
    readouts(other, hop);
    tellKind(other);
    at("unpin").disabled = a === original;
  }

  function pin() {
    const { hop } = state;
    if (!hop) return;
    state.a = { series: hop.series, figures: hop.figures, multipliers: hop.multipliers, knobs: hop.knobs, view: hop.view,
      kept: hop.kept, verdict: hop.verdict, kind: hop.kind, name: "A, pinned" };
    compare();
  }

  function unpin() {
    state.a = original;
    if (state.hop) compare();
  }

  function complain(text) {
    at("problem").textContent = text;
    at("problem").hidden = !text;
  }

  function place() {
    sliders.show(state.knobs);
    for (const input of document.getElementsByName("view")) input.checked = input.value === state.view;
    at("keep").checked = state.kept;
    if (data.solved) sliders.enable(data.solved, !state.kept);
  }

  // what is asked for, and what comes of it

  const query = (changes = {}) => "?" + new URLSearchParams({ ...state.knobs, ...changes, view: state.view,
    ...(state.kept ? { keep: "yes" } : {}) });

  // what is shown `instead` of a motion that there is not leaves what was said of that
  function heard(hop, { search, adopt, keep, instead }, latest) {
    if (!keep) complain("");
    if (adopt) take({ knobs: { ...hop.knobs }, view: hop.view, kept: hop.kept });
    if (!instead) tell(hop);
    if (hop.verdict === "none") {
      tangents.clear();
      if (hop.onward) return { search, keep, instead };
      return state.hop ? null : { search: "", keep: true, instead: true }; // the default one, to begin with
    }
    if (state.kept && hop.kept && latest) take({ knobs: { ...state.knobs, [data.solved]: hop.knobs[data.solved] } });
    at("script").href = "/script" + (instead ? search : query());
    show(hop, search);
    return true;
  }

  function take(numbers) {
    Object.assign(state, numbers);
    place();
    history.replaceState(null, "", query() + location.hash);
  }

  function refused(error) {
    complain(error);
    outdate(true, true);
    return state.hop ? null : { search: query(), keep: true }; // something to begin with
  }

  let entered = -Infinity;
  function enter() { // into the history, a burst of changes once
    const now = performance.now();
    if (location.search !== query()) history[now - entered > PATIENCE ? "pushState" : "replaceState"](null, "", query());
    entered = now;
  }

  // what the reader wants
  function want(changes) {
    Object.assign(state, changes);
    place();
    ask(query());
  }

  function turn(name, value) {
    tangents.over(name);
    want({ knobs: { ...state.knobs, [name]: value } });
  }

  function choose(changes) {
    want(changes);
    enter();
  }

  const setKept = (kept) => choose({ kept });
  const takeA = () => choose({ knobs: { ...state.a.knobs } });
  const reset = () => choose({ view: data.views[0], knobs: { ...defaults }, kept: false });

  // saved by the browser

  const titled = () => ({ title: data.title, start: 0, spans: state.hop.spans });
  const saveCsv = () => state.hop && saveSamples(readSamples(state.hop.samples), titled());
  const savePng = () => state.hop && savePicture(viewer, titled(), clock.time);

  function build() {
    for (const view of data.views) {
      const input = make("input", { type: "radio", name: "view", value: view });
      input.addEventListener("change", () => {
        named = 0;
        choose({ view });
      });
      at("views").append(make("label", {}, input, make("span", {}, VIEWS[view])));
    }
    at("views").addEventListener("keydown", (event) => event.key === " " && event.stopPropagation());
    at("views").hidden = data.views.length < 2;
    at("keeping").hidden = !data.keeps;
    at("keeping").querySelector("span").textContent = `Keep ${data.keeps}: the torque is solved for`;
    at("keep").addEventListener("change", () => setKept(at("keep").checked));
    for (const [text, color] of data.legend)
      at("legend").append(make("li", {}, make("i", { style: `background:${color}` }), text));
    const origins = new Set(names.map((name) => data.knobs[name].origin));
    at("origins").append(...[...origins].map((origin) => make("span", { class: origin }, ORIGINS_SAID[origin])));
    const [said, lasting] = data.said;
    at("said").textContent = said;
    if (!data.engine.extra)
      at("engine").textContent = "Without the extra fast (pip install '.[fast]' in the package's folder) every change takes "
        + `${lasting}.`;
    at("panel").addEventListener("submit", (event) => event.preventDefault());
    const clicks = { reset, pin, unpin, back: takeA, csv: saveCsv, png: savePng };
    for (const [id, act] of Object.entries(clicks)) at(id).addEventListener("click", act);
    addEventListener("popstate", () => ask(location.search, { adopt: true }));
  }

  build();
  makeKeys([
    ...transport.keys,
    ...timeline.keys,
    { keys: ["j"], label: "to the next slider", act: () => sliders.step(1) },
    { keys: ["k"], label: "to the slider before", act: () => sliders.step(-1) },
    { keys: ["p"], label: "pin the present motion as A", act: pin },
    { keys: ["x"], label: "unpin: compare with the default", act: unpin },
    { keys: ["b"], label: "back to the numbers of A", act: takeA },
    ...(data.keeps ? [{ keys: ["f"], label: `keep ${data.keeps}, or not`, act: () => setKept(!state.kept) }] : []),
    { keys: ["0"], label: "all numbers as at first", act: reset },
    { keys: ["c"], label: "save the samples as CSV", act: saveCsv },
    { keys: ["i"], label: "save the picture as PNG", act: savePng },
    ...camera.views.map((view, i) => ({ keys: [String(i + 1)], label: `view: ${view}`, act: () => camera.setView(view) })),
  ], at);
  place();
  clock.setPlaying(playing);
  window.explorer = { state, viewer, camera, clock, pin, unpin, setKept, seek: clock.seek, timings: questions.timings,
    idle: questions.idle, tangents, opened: ask(location.search, { adopt: true }) };
})();
