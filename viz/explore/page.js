(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const DOMAINS = { stance: "#2f5fa8", flight: "#7b96ad" };
  const SLIPPING = "#c2873a";
  const VIEWS = { settled: "settled", transient: "first hops" };
  const HOLD = 0.8; // s at the end of what does not repeat
  const PATIENCE = 1000; // ms between entries of the history
  const names = Object.keys(data.knobs);
  const defaults = Object.fromEntries(names.map((name) => [name, data.knobs[name].default]));

  const state = { view: data.views[0], knobs: { ...defaults }, hop: null, time: 0, speed: 1, playing: true };
  const timings = []; // of what was shown, in ms

  function make(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children);
    return element;
  }

  const decimal = (value, digits) => value.toFixed(digits).replace("-", "−");

  // the scene

  const viewer = openViewer(at("pane"), data.scene, data);
  const resize = viewer.set_3d_pane_size.bind(viewer);
  viewer.set_3d_pane_size = () => { // its own fills the window
    const { clientWidth, clientHeight } = at("pane");
    viewer.camera.zoom = 0.94 * Math.min(1, clientWidth / clientHeight / data.aspect);
    resize(clientWidth, clientHeight);
  };

  // the time

  function seek(time) {
    const { hop } = state;
    state.time = time;
    const shown = Math.max(0, Math.min(hop.duration, time));
    viewer.animator.seek(shown);
    const span = hop.spans.filter((span) => span[1] <= shown).pop() || hop.spans[0];
    at("domain").textContent = span[0];
    at("domain").style.background = colorOf(span[0]);
    at("time").textContent = shown.toFixed(3) + " s";
    at("scrubber").value = shown;
    for (const plot of plots) plot.point(shown);
  }

  function colorOf(domain) {
    return DOMAINS[domain] || SLIPPING;
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

  let last = performance.now();
  function tick(now) {
    const passed = Math.min(0.1, Math.max(0, (now - last) / 1000)) * state.speed;
    last = now;
    if (state.playing && state.hop && !asking) { // frames of the old hop would hold up the new one
      const hold = state.hop.verdict === "periodic" || state.hop.verdict === "pattern" ? 0 : HOLD;
      seek((state.time + passed) % (state.hop.duration + hold));
    }
    requestAnimationFrame(tick);
  }

  // the plots

  function niceTicks(low, high, count) {
    const rough = (high - low || 1) / count;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= rough);
    const first = Math.floor(low / step + 1e-9);
    const last = Math.ceil(high / step - 1e-9);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    return Array.from({ length: last - first + 1 }, (_, i) => [(first + i) * step, decimal((first + i) * step, digits)]);
  }

  class Plot {
    constructor([title, unit, lines]) {
      this.lines = lines;
      const labels = Object.values(lines).filter(([label]) => label);
      const legend = labels.map(([label, color]) => make("span", {}, make("i", { style: `background:${color}` }), label));
      this.svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
      this.svg.setAttribute("role", "img");
      this.svg.setAttribute("aria-label", `${title} in ${unit} over time in s`);
      this.cursor = make("i", { class: "cursor" });
      const chart = make("div", { class: "chart" }, this.svg, this.cursor);
      at("plots").append(make("div", { class: "plot" }, make("h2", {}, `${title} (${unit})`, ...legend), chart));
      const drag = (event) => {
        if (!event.buttons || !state.hop) return;
        const x = event.clientX - this.svg.getBoundingClientRect().left;
        setPlaying(false);
        seek(Math.max(0, Math.min(state.hop.duration, ((x - this.left) / (this.right - this.left)) * state.hop.duration)));
      };
      this.svg.addEventListener("pointerdown", drag);
      this.svg.addEventListener("pointermove", drag);
    }

    draw(hop) {
      const { clientWidth: width, clientHeight: height } = this.svg;
      [this.left, this.right, this.top, this.bottom] = [38, width - 8, 6, height - 18];
      const before = data.default.series;
      const until = before.t.findIndex((time) => time > hop.duration);
      const values = Object.keys(this.lines).flatMap((name) =>
        [...hop.series[name], ...before[name].slice(0, until < 0 ? undefined : until)]);
      const ticks = niceTicks(values.reduce((a, b) => Math.min(a, b)), values.reduce((a, b) => Math.max(a, b)), 5);
      const [low, high] = [ticks[0][0], ticks[ticks.length - 1][0]];
      this.x = (time) => this.left + (time / hop.duration) * (this.right - this.left);
      const y = (value) => this.bottom - ((value - low) / (high - low)) * (this.bottom - this.top);
      const path = (t, values, length = t.length) => {
        let text = "";
        for (let i = 0; i < length; i++) text += (i ? "L" : "M") + this.x(t[i]).toFixed(1) + " " + y(values[i]).toFixed(1);
        return text;
      };
      const parts = hop.spans.filter(([name]) => name.startsWith("stance")).map(([, begin, end]) =>
        `<rect class="stance" x="${this.x(begin)}" y="${this.top}" width="${this.x(end) - this.x(begin)}" height="${this.bottom - this.top}"/>`);
      for (const [value, text] of ticks)
        parts.push(`<path class="grid" d="M${this.left} ${y(value)}H${this.right}"/>`,
          `<text x="${this.left - 5}" y="${y(value) + 4}" text-anchor="end">${text}</text>`);
      for (const [value, text] of niceTicks(0, hop.duration, 5).filter(([value]) => value <= hop.duration))
        parts.push(`<text x="${this.x(value)}" y="${height - 4}" text-anchor="middle">${text}</text>`);
      const own = names.every((name) => hop.knobs[name] === defaults[name]);
      for (const name of own ? [] : Object.keys(this.lines))
        parts.push(`<path class="before" d="${path(before.t, before[name], until < 0 ? undefined : until)}"/>`);
      for (const [name, [, color]] of Object.entries(this.lines))
        parts.push(`<path stroke="${color}" d="${path(hop.series.t, hop.series[name])}"/>`);
      this.svg.innerHTML = parts.join("");
    }

    point(time) {
      this.cursor.style.transform = `translateX(${this.x(time)}px)`; // a layer of its own: the plot is not painted again
    }
  }

  const plots = data.plots.map((plot) => new Plot(plot));

  // what is shown

  function show(hop) {
    state.hop = hop;
    for (const path of data.overlays) viewer.handle_command({ type: "delete", path });
    handle(viewer, hop.commands);
    for (const plot of plots) plot.draw(hop);
    const stops = hop.spans.map(([name, begin, end]) =>
      `${colorOf(name)} ${(100 * begin) / hop.duration}% ${(100 * end) / hop.duration}%`);
    at("spans").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    at("spans").replaceChildren(...hop.events.map(([name, time]) =>
      make("i", { style: `left:${(100 * time) / hop.duration}%`, title: name })));
    at("scrubber").max = hop.duration;
    at("verdict").textContent = hop.message;
    at("verdict").className = hop.verdict;
    for (const [name, [, unit, digits]] of Object.entries(data.readouts)) {
      const value = hop.figures[name];
      const text = value === null ? "–" : decimal(unit === "%" ? 100 * value : value, digits);
      at("figure_" + name).replaceChildren(text + " ", make("small", {}, value === null ? "" : unit));
    }
    const pairs = hop.multipliers.filter(([, imaginary]) => imaginary >= 0);
    const texts = pairs.map(([real, imaginary]) => decimal(real, 3) + (imaginary ? ` ± ${decimal(imaginary, 3)}i` : ""));
    at("multipliers").textContent = texts.join(", ") || "–";
    seek(state.time % hop.duration);
  }

  function complain(text) {
    at("problem").textContent = text;
    at("problem").hidden = !text;
  }

  function place() {
    for (const name of names) for (const input of document.getElementsByName(name)) input.value = state.knobs[name];
    for (const input of document.getElementsByName("view")) input.checked = input.value === state.view;
  }

  // asking; while an answer is awaited only the latest wish is kept

  const query = (changes = {}) => "?" + new URLSearchParams({ ...state.knobs, ...changes, view: state.view });
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
        const response = await fetch("/hop" + search, { headers: { [data.client]: client } });
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
          state.knobs = hop.knobs;
          state.view = hop.view;
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

  // the controls

  function buildKnob(name) {
    const knob = data.knobs[name];
    const unit = knob.unit === "1" ? "" : knob.unit;
    const number = make("input", { type: "number", name, id: "number_" + name, min: knob.low, max: knob.high, step: "any" });
    const label = make("label", { for: number.id }, make("span", {}, knob.label), number, make("span", { class: "unit" }, unit));
    const slider = make("input", { type: "range", name, min: knob.low, max: knob.high, step: "any",
      "aria-label": `${knob.label}${unit ? " in " + unit : ""}` });
    const part = (knob.default - knob.low) / (knob.high - knob.low);
    const mark = make("i", { class: knob.origin, style: `left:calc(8px + (100% - 16px) * ${part})` });
    const origin = make("button", { type: "button", class: `origin ${knob.origin}`, title: `Back to ${knob.default}` },
      `${knob.origin} ${knob.default}, ${knob.note}`);
    slider.addEventListener("input", () => turn(name, Number(Number(slider.value).toFixed(knob.digits))));
    slider.addEventListener("change", enter);
    number.addEventListener("change", () => {
      if (!number.value || !number.checkValidity()) return ask(query({ [name]: number.value })); // it says what is valid
      turn(name, Number(number.value));
      enter();
    });
    origin.addEventListener("click", () => (turn(name, knob.default), enter()));
    at("knobs").append(make("div", { class: "knob" }, label, make("div", { class: "track" }, mark, slider), origin));
  }

  function build() {
    names.forEach(buildKnob);
    for (const view of data.views) {
      const input = make("input", { type: "radio", name: "view", value: view });
      input.addEventListener("change", () => ((state.view = view), (state.time = 0), ask(query()), enter()));
      at("views").append(make("label", {}, input, make("span", {}, VIEWS[view])));
    }
    for (const [name, [label]] of Object.entries(data.readouts))
      at("readouts").append(make("div", {}, make("dt", { title: label }, label), make("dd", { id: "figure_" + name })));
    at("readouts").append(make("div", { class: "wide" }, make("dt", {}, "Multipliers"), make("dd", { id: "multipliers" })));
    for (const [text, color] of data.legend)
      at("legend").append(make("li", {}, make("i", { style: `background:${color}` }), text));
    if (!data.engine.extra)
      at("engine").textContent = "Without the extra fast (pip install '.[fast]' in the package's folder) every change takes a second or so.";
    for (const speed of data.speeds) {
      const button = make("button", { type: "button", value: speed }, speed + "×");
      button.addEventListener("click", () => setSpeed(speed));
      at("speeds").append(button);
    }
    at("play").addEventListener("click", () => setPlaying(!state.playing));
    at("scrubber").addEventListener("input", () => (setPlaying(false), seek(Number(at("scrubber").value))));
    at("reset").addEventListener("click", () => {
      Object.assign(state, { view: data.views[0], knobs: { ...defaults } });
      place();
      ask(query());
      enter();
    });
    at("panel").addEventListener("submit", (event) => event.preventDefault());
    addEventListener("popstate", () => ask(location.search, true));
    new ResizeObserver(() => {
      viewer.set_3d_pane_size();
      if (!state.hop) return;
      for (const plot of plots) plot.draw(state.hop);
      seek(state.time);
    }).observe(document.body);
  }

  build();
  place();
  setSpeed(data.speeds[0]);
  const wanted = /[#&]t=([\d.]+)/.exec(location.hash);
  if (wanted) state.time = Number(wanted[1]);
  setPlaying(!wanted && !matchMedia("(prefers-reduced-motion: reduce)").matches);
  requestAnimationFrame(tick);
  window.explorer = { state, timings, viewer, seek, idle: () => asking, opened: ask(location.search, true) };
})();
