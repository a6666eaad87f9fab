// what is no column of the samples: when feet are on the ground, and the way from above

const FEET = "feet_on_the_ground";
const PLAN = "way_from_above";

// these among the samples' columns, to be chosen like them
function addPictures(samples, { footfalls, prints }) {
  const made = [];
  if (footfalls.length > 1) {
    const bars = footfalls.map(([label, color, spans]) => ({ label, color, spans }));
    made.push({ name: FEET, kind: "feet on the ground", unit: "", title: "feet on the ground", bars });
  }
  const along = ["q_torso_x", "q_torso_y"].map((name) => samples.byName.get(name));
  if (along.every(Boolean)) {
    const plan = { x: along[0], y: along[1], prints };
    made.push({ name: PLAN, kind: "from above", unit: "m", title: "way from above [m]", plan });
  }
  for (const each of made) {
    samples.columns.push({ values: new Float32Array(samples.t.length), ...each });
    samples.byName.set(each.name, samples.columns[samples.columns.length - 1]);
  }
}

// the way of the torso, where feet came down, and where it is now; x to the right, y up, one scale for both
function makePlan({ kind, unit, plan: { x, y, prints } }, samples, panel) {
  const make = (tag, attributes, parent) => {
    const element = document.createElementNS(parent.namespaceURI, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    parent.append(element);
    return element;
  };
  const figure = document.createElement("figure");
  figure.className = "plot plan";
  const caption = document.createElement("figcaption");
  const head = document.createElement("span");
  head.textContent = `${kind} (${unit})`;
  caption.append(head);
  const chart = document.createElement("div");
  chart.className = "chart";
  figure.append(caption, chart);
  panel.append(figure);
  chart.innerHTML = '<svg role="img" aria-label="Way of the torso and footprints from above, in m"></svg>';
  const svg = chart.firstChild;
  const reach = (values, others) => {
    const all = [...values, ...others];
    return [all.reduce((a, b) => Math.min(a, b)), all.reduce((a, b) => Math.max(a, b))];
  };
  const [[left, right], [low, high]] = [reach(x.values, prints.map(([at]) => at)), reach(y.values, prints.map(([, at]) => at))];
  let dot = null;
  let place = () => [0, 0];

  function fit() {
    const { clientWidth: width, clientHeight: height } = chart;
    if (!width || !height) return;
    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const [margin, foot, rest] = [46, 18, 10];
    const scale = Math.min((width - margin - rest) / Math.max(right - left, 0.5), (height - foot - rest) / Math.max(high - low, 0.5));
    const [middleX, middleY] = [(margin + width - rest) / 2, (height - foot + rest) / 2];
    place = (px, py) => [middleX + (px - (left + right) / 2) * scale, middleY - (py - (low + high) / 2) * scale];
    const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find((each) => each * scale >= 44) || 200;
    const ticks = (from, to) => {
      const found = [];
      for (let i = Math.ceil(from / step); i * step <= to; i++) found.push(Number((i * step).toFixed(3)));
      return found;
    };
    const [x0, x1] = [margin, width - rest].map((at) => (left + right) / 2 + (at - middleX) / scale);
    const [y0, y1] = [height - foot, rest].map((at) => (low + high) / 2 + (middleY - at) / scale);
    for (const tick of ticks(x0, x1)) {
      const [at] = place(tick, 0);
      make("line", { x1: at, x2: at, y1: rest, y2: height - foot }, svg);
      make("text", { x: at, y: height - 5, "text-anchor": "middle" }, svg).textContent = String(tick).replace("-", "−");
    }
    for (const tick of ticks(y0, y1)) {
      const [, at] = place(0, tick);
      make("line", { x1: margin, x2: width - rest, y1: at, y2: at }, svg);
      make("text", { x: margin - 5, y: at + 4, "text-anchor": "end" }, svg).textContent = String(tick).replace("-", "−");
    }
    for (const [px, py, color] of prints) {
      const [cx, cy] = place(px, py);
      make("circle", { cx, cy, r: 2, fill: color }, svg);
    }
    const points = Array.from(x.values, (px, i) => place(px, y.values[i]).map((at) => at.toFixed(1)).join(",")).join(" ");
    make("polyline", { points }, svg);
    dot = make("circle", { r: 4.5, class: "now" }, svg);
  }

  function point(time) {
    if (!dot) return;
    const value = samples.at(time);
    const [cx, cy] = place(value(x), value(y));
    dot.setAttribute("cx", cx);
    dot.setAttribute("cy", cy);
  }

  return { columns: [], values: [], fit, point, mark() {}, destroy: () => figure.remove() };
}
