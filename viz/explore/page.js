// the page: it asks its server what becomes of the numbers, and shows it

(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const VIEWS = { settled: "settled", transient: "first hops", stride: "a stride" };
  const REPEATS = ["periodic", "pattern"];
  const HOLD = 0.8; // s at the end of what does not repeat
  const PATIENCE = 1000; // ms between entries of the history
  const names = Object.keys(data.knobs);
  const defaults = Object.fromEntries(names.map((name) => [name, data.knobs[name].default]));
  const original = { ...data.default, name: "A, the default" };

  const state = { view: data.views[0], knobs: { ...defaults }, kept: false, hop: null, a: original, time: 0, speed: 1,
    playing: true };
  const timings = []; // of what was shown, in ms

  const decimal = (value, digits) => value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−");

  const viewer = openViewer(at("pane"), data.scene, data);
  paintScene(viewer, data);
  const camera = makeCamera(viewer, at("pane"), data);
  const plots = makeComparison(data, at("plots"), pauseAt);
  const sliders = makeSliders(data.knobs, at("knobs"), {
    turn,
    enter,
    refuse: (name, text) => ask(query({ [name]: text })), // the answer says what is valid
  });

  // the time

  function seek(time) {
    const { hop } = state;
    state.time = time;
    if (!hop) return;
    const shown = Math.max(0, Math.min(hop.duration, time));
    viewer.animator.seek(shown);
    camera.onTime();
    const [name] = hop.spans.filter((span) => span[1] <= shown).pop() || hop.spans[0];
    at("domain").textContent = name;
    Object.assign(at("domain").style, { background: colorOf(name), color: inkOn(colorOf(name)) });
    at("time").textContent = shown.toFixed(3) + " s";
    at("scrubber").value = shown;
    if (!state.playing) at("scrubber").setAttribute("aria-valuetext", `${shown.toFixed(3)} s, ${name}`);
    plots.point(shown);
  }

  function pauseAt(time) {
    setPlaying(false);
    seek(time);
  }

  function step(way) {
    if (state.hop) pauseAt(Math.max(0, Math.min(state.hop.duration, state.time + way / 60)));
  }

  function setPlaying(playing) {
    state.playing = playing;
    at("play").classList.toggle("playing", playing);
    at("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  }

  function setSpeed(speed) {
    state.speed = speed;
    for (const button of at("speeds").children) button.setAttribute("aria-pressed", Number(button.value) === speed);
  }

  function nextSpeed(way) {
    const faster = [...data.speeds].sort((a, b) => a - b);
    setSpeed(faster[Math.max(0, Math.min(faster.length - 1, faster.indexOf(state.speed) + way))]);
  }

  let last = performance.now();
  function tick(now) {
    const passed = Math.min(0.1, Math.max(0, (now - last) / 1000)) * state.speed;
    last = now;
    if (state.playing && state.hop && !asking) { // frames of the old motion would hold up the new one
      const hold = REPEATS.includes(state.hop.verdict) ? 0 : HOLD;
      seek((state.time + passed) % (state.hop.duration + hold));
    }
    requestAnimationFrame(tick);
  }

  // what is shown

  function show(hop) {
    state.hop = hop;
    for (const path of data.overlays) viewer.handle_command({ type: "delete", path });
    handle(viewer, hop.commands);
    const stops = hop.spans.map(([name, begin, end]) =>
      `${colorOf(name)} ${(100 * begin) / hop.duration}% ${(100 * end) / hop.duration}%`);
    at("spans").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    at("spans").replaceChildren(...hop.events.map(([name, time]) =>
      make("i", { style: `left:${(100 * time) / hop.duration}%`, title: name })));
    at("scrubber").max = hop.duration;
    const pairs = hop.multipliers.filter(([real, imaginary]) => imaginary >= 0 && Math.hypot(real, imaginary) >= 5e-4);
    const texts = pairs.map(([real, imaginary]) => decimal(real, 3) + (imaginary ? ` ± ${decimal(imaginary, 3)}i` : ""));
    at("multipliers").textContent = texts.join(", ") || "–";
    compare();
    seek(state.time % hop.duration);
  }

  function tell({ message, verdict, onward }) {
    at("verdict").textContent = onward ? "On the way there. " + message : message;
    at("verdict").className = verdict;
    document.body.classList.toggle("stale", verdict === "none");
  }

  const sameNumbers = (a, b) => names.every((name) => a[name] === b[name]);

  // the figures of B, and by how much they differ from those of A
  function compare() {
    const { a, hop } = state;
    const other = a.name !== original.name || !sameNumbers(a.knobs, hop.knobs);
    plots.show(other ? a : null, hop);
    for (const [name, [, unit, digits]] of Object.entries(data.readouts)) {
      const scale = unit === "%" ? 100 : 1;
      const [value, was] = [hop.figures[name], a.figures[name]];
      const parts = value === null ? ["–"] : [decimal(scale * value, digits) + " ", make("small", {}, unit)];
      at("figure_" + name).replaceChildren(...parts);
      const both = other && value !== null && was !== null;
      const change = both ? decimal(scale * (value - was), digits) : "";
      const from = both ? `${decimal(scale * was, digits)} in A` : "";
      at("change_" + name).textContent = both ? (Number(change) > 0 ? "+" : "") + change : "";
      at("change_" + name).title = from;
    }
    at("unpin").disabled = a.name === original.name;
    at("readouts").title = other ? `small: the difference from ${a.name}` : "";
  }

  function pin() {
    const { hop } = state;
    if (!hop) return;
    state.a = { series: hop.series, figures: hop.figures, knobs: hop.knobs, name: "A, pinned" };
    compare();
  }

  function unpin() {
    state.a = original;
    if (state.hop) compare();
  }

  function takeA() {
    state.knobs = { ...state.a.knobs };
    place();
    ask(query());
    enter();
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

  // asking; while an answer is awaited only the latest wish is kept

  const query = (changes = {}) => "?" + new URLSearchParams({ ...state.knobs, ...changes, view: state.view,
    ...(state.kept ? { keep: "yes" } : {}) });
  const client = crypto.randomUUID();
  let wish = null;
  let asking = null;

  function ask(search, adopt = false) {
    wish = { search, adopt, begun: performance.now() };
    asking = asking || answerWishes().finally(() => (asking = null));
    return asking;
  }

  async function answerWishes() {
    document.body.classList.add("busy");
    while (wish) {
      const { search, adopt, keep, begun } = wish;
      wish = null;
      try {
        const sent = performance.now();
        const response = await fetch("/" + data.kind + search, { headers: { [data.client]: client } });
        const hop = await response.json();
        const received = performance.now();
        if (response.status === 409) continue; // it has something newer to compute for this page
        if (!response.ok) {
          complain(hop.error);
          if (!state.hop) wish = wish || { search: query(), keep: true, begun }; // something to begin with
          continue;
        }
        if (!keep) complain("");
        if (adopt) {
          Object.assign(state, { knobs: { ...hop.knobs }, view: hop.view, kept: hop.kept });
          place();
          history.replaceState(null, "", query() + location.hash);
        }
        tell(hop);
        if (hop.verdict === "none") {
          if (hop.onward) wish = wish || { search, keep, begun };
          else if (!state.hop) wish = wish || { search: "", keep: true, begun }; // the default one, to begin with
          continue;
        }
        if (state.kept && hop.kept && !wish) {
          state.knobs[data.solved] = hop.knobs[data.solved];
          place();
          history.replaceState(null, "", query() + location.hash);
        }
        at("script").href = "/script" + query();
        show(hop);
        await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
        const server = (response.headers.get("Server-Timing") || "").matchAll(/(\w+);dur=([\d.]+)/g);
        timings.push({ search, waited: sent - begun, answered: received - sent, rendered: performance.now() - received,
          total: performance.now() - begun, ...Object.fromEntries([...server].map(([, name, ms]) => [name, Number(ms)])) });
      } catch (problem) {
        complain("No answer: has `spear explore` ended?");
      }
    }
    document.body.classList.remove("busy");
  }

  let entered = -Infinity;
  function enter() { // into the history, a burst of changes once
    const now = performance.now();
    if (location.search !== query()) history[now - entered > PATIENCE ? "pushState" : "replaceState"](null, "", query());
    entered = now;
  }

  function turn(name, value) {
    state.knobs[name] = value;
    place();
    ask(query());
  }

  function setKept(kept) {
    state.kept = kept;
    place();
    ask(query());
    enter();
  }

  function reset() {
    Object.assign(state, { view: data.views[0], knobs: { ...defaults }, kept: false });
    place();
    ask(query());
    enter();
  }

  const titled = () => ({ title: data.title, start: 0, spans: state.hop.spans });

  function build() {
    for (const view of data.views) {
      const input = make("input", { type: "radio", name: "view", value: view });
      input.addEventListener("change", () => (Object.assign(state, { view, time: 0 }), ask(query()), enter()));
      at("views").append(make("label", {}, input, make("span", {}, VIEWS[view])));
    }
    at("views").addEventListener("keydown", (event) => event.key === " " && event.stopPropagation());
    at("views").hidden = data.views.length < 2;
    at("keeping").hidden = !data.keeps;
    at("keeping").querySelector("span").textContent = `Keep ${data.keeps}: the torque is solved for`;
    at("keep").addEventListener("change", () => setKept(at("keep").checked));
    for (const [name, [label]] of [...Object.entries(data.readouts)])
      at("readouts").append(make("div", {}, make("dt", { title: label }, label),
        make("dd", {}, make("span", { id: "figure_" + name }), " ", make("span", { id: "change_" + name, class: "change" }))));
    at("readouts").append(make("div", { class: "wide" }, make("dt", {}, "Multipliers"), make("dd", { id: "multipliers" })));
    for (const [text, color] of data.legend)
      at("legend").append(make("li", {}, make("i", { style: `background:${color}` }), text));
    const origins = new Set(names.map((name) => data.knobs[name].origin));
    at("origins").append(...[...origins].map((origin) => make("span", { class: origin }, ORIGINS_SAID[origin])));
    at("said").textContent = data.kind === "hop" ? "Unless the flight time is kept, the torque stays where its slider is."
      : "The posterior hip torque is solved for the speed.";
    if (!data.engine.extra)
      at("engine").textContent = "Without the extra fast (pip install '.[fast]' in the package's folder) every change takes "
        + (data.kind === "hop" ? "a second or so." : "five to ten seconds.");
    for (const speed of data.speeds) {
      const button = make("button", { type: "button", value: speed }, speed + "×");
      button.addEventListener("click", () => setSpeed(speed));
      at("speeds").append(button);
    }
    at("scrubber").addEventListener("input", () => pauseAt(Number(at("scrubber").value)));
    at("panel").addEventListener("submit", (event) => event.preventDefault());
    const clicks = { play: () => setPlaying(!state.playing), reset, pin, unpin, back: takeA, csv: saveCsv, png: savePng,
      keys: () => at("help").showModal() };
    for (const [id, act] of Object.entries(clicks)) at(id).addEventListener("click", act);
    addEventListener("popstate", () => ask(location.search, true));
  }

  function saveCsv() {
    if (state.hop) saveSamples(readSamples(state.hop.samples), titled());
  }

  function savePng() {
    if (state.hop) savePicture(viewer, titled(), state.time);
  }

  build();
  makeKeys([
    { keys: [" "], label: "play, pause", act: () => setPlaying(!state.playing) },
    { keys: [","], label: "one frame back", act: () => step(-1) },
    { keys: ["."], label: "one frame on", act: () => step(1) },
    { keys: ["-"], label: "slower", act: () => nextSpeed(-1) },
    { keys: ["+", "="], label: "faster", act: () => nextSpeed(1) },
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
    { keys: ["?"], label: "this list", act: () => at("help").showModal() },
  ], at("help"), at("keylist"));
  place();
  setSpeed(data.speeds[0]);
  const wanted = /[#&]t=([\d.]+)/.exec(location.hash);
  if (wanted) state.time = Number(wanted[1]);
  setPlaying(!wanted && !matchMedia("(prefers-reduced-motion: reduce)").matches);
  requestAnimationFrame(tick);
  window.explorer = { state, timings, viewer, camera, seek, pin, unpin, setKept, idle: () => asking,
    opened: ask(location.search, true) };
})();
