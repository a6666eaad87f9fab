// what one more unit of each number does to a figure: said beside the sliders, drawn as a tangent over one of them

const LATER = 250; // ms after an answer: a hand that goes on turning waits for no derivatives
const NOTHING = 1e-7; // of a figure, which is not told from rounding
const SEEN = 500; // motions that are remembered at most

// `questions` are those of the page
function makeTangents(data, questions, at) {
  const names = Object.keys(data.knobs);
  const choice = at("effect");
  const labels = { ...data.readouts, [data.multiplier]: ["Largest multiplier", "", 3] };
  const state = { hop: null, search: "", found: {}, over: names[0], a: null };
  const seen = [];
  let timer = 0;
  const plot = data.effects.length ? makeTangentPlot(at("plots")) : null;
  const path = () => (choice.value === data.multiplier ? "/tangents/multiplier" : "/tangents");
  const valueOf = ({ figures, multipliers }) =>
    choice.value !== data.multiplier ? figures[choice.value] : multipliers.length ? Math.hypot(...multipliers[0]) : null;

  function show(hop, search) {
    const { knobs, view, kept, verdict, figures, multipliers } = hop;
    if (seen.push({ knobs, view, kept, verdict, figures, multipliers }) > SEEN) seen.shift();
    Object.assign(state, { hop, search, found: {} });
    later();
  }

  function later() {
    clearTimeout(timer);
    if (!plot || !state.hop) return;
    timer = setTimeout(ask, LATER);
  }

  async function ask() {
    const [asked, search] = [path(), state.search];
    try {
      await questions.idle();
      if (state.search !== search || state.found[asked]) return;
      const response = await questions.get(asked + search);
      const said = await response.json();
      if (state.search !== search || response.status === 409) return; // something newer is wanted
      if (response.status === 503) return later(); // the server has too much to compute
      state.found[asked] = response.ok ? said : { slopes: {}, refused: {}, reason: said.error, one_sided: [] };
      draw();
    } catch (problem) {
      // the page's next question says that there is no server
    }
  }

  function clear() {
    clearTimeout(timer);
    Object.assign(state, { hop: null, search: null, found: {} });
    draw();
  }

  // texts

  const signed = (value, digits) => {
    const text = String(Number(Math.abs(value).toPrecision(digits)));
    return (value < 0 ? "−" : "+") + text;
  };

  function withUnit(value, unit) {
    const factors = unit ? [[1, ""], [1e3, "m"], [1e6, "µ"]] : [[1, ""]];
    const [factor, prefix] = factors.find(([each]) => Math.abs(value) * each >= 0.01) || factors.at(-1);
    return `${signed(value * factor, 3)} ${prefix}${unit}`.trim();
  }

  function told(name, slope, value) {
    const knob = data.knobs[name];
    if (Math.abs(slope) * (knob.high - knob.low) < NOTHING * Math.abs(value)) return "no effect";
    const share = (slope * state.hop.knobs[name]) / value;
    const relative = !Number.isFinite(share) || !share ? "" : Math.abs(share) < 5e-4 ? ", 0.000 %/%" : `, ${signed(share, 2)} %/%`;
    return `${withUnit(slope, labels[choice.value][1])} per ${knob.unit || 1}${relative}`;
  }

  function say(name, answer) {
    const line = at("effect_" + name);
    line.classList.toggle("old", !answer);
    if (!answer && state.hop) return; // what was, until it is known
    const slope = answer ? answer.slopes[name]?.[choice.value] : null;
    const known = slope !== null && slope !== undefined;
    line.textContent = known ? told(name, slope, valueOf(state.hop)) : "no derivative";
    line.title = known ? "" : answer ? answer.refused[name] || answer.reason || "it is none of a whole cycle's, or the order of events changes too near"
      : "there is no such motion";
  }

  function draw() {
    if (!plot) return;
    const { hop, over, a } = state;
    const answer = state.found[path()];
    for (const name of names) say(name, answer);
    at("said_of_effect").textContent = !answer ? "" : answer.reason ? `None: ${answer.reason}.`
      : answer.one_sided.length ? `One-sided, for events meet: ${answer.one_sided.join(", ").replaceAll("_", " ")}.` : "";
    if (!hop) return;
    const [label, unit] = labels[choice.value];
    const free = new Set([over, hop.kept ? data.solved : ""]);
    const beside = (other) => other.verdict === "periodic" && other.view === hop.view && Boolean(other.kept) === hop.kept
      && names.every((name) => free.has(name) || other.knobs[name] === hop.knobs[name]);
    const point = (other) => [other.knobs[over], valueOf(other)];
    plot.show({
      knob: data.knobs[over],
      label,
      unit,
      points: seen.filter(beside).map(point),
      a: a && beside(a) ? point(a) : null,
      here: hop.verdict === "periodic" ? point(hop) : null,
      slope: answer?.slopes[over]?.[choice.value] ?? null,
    });
  }

  for (const name of data.effects) choice.append(make("option", { value: name }, labels[name][0]));
  at("effects").hidden = !plot;
  choice.addEventListener("change", () => (draw(), later()));
  if (plot) watchTheme(draw);

  return {
    show,
    clear,
    // the slider over which it is drawn
    over(name) {
      state.over = name;
      draw();
    },
    // with A
    compare(a) {
      state.a = a;
      draw();
    },
    drawn: () => plot.drawn(),
    // the answer, when it is there
    async arrived() {
      await questions.idle();
      while (plot && state.hop && !state.found[path()]) await new Promise((done) => setTimeout(done, 20));
      return state.found[path()] ?? null;
    },
  };
}
