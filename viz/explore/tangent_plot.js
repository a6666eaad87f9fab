// a figure over the number of one slider: motions that were shown, the present one, A as a ring, and the tangent

const REACH = 0.15; // of a slider's range, that is drawn either way

function makeTangentPlot(panel) {
  const figure = make("figure", { class: "plot", id: "tangent" });
  const caption = make("figcaption");
  const chart = make("div", { class: "chart" });
  figure.append(caption, chart);
  panel.append(figure);
  let plot = null;

  function legend(head, entries) {
    const items = entries.map(([color, text]) => make("span", {}, make("i", { style: `background:${color}` }), text));
    caption.replaceChildren(make("span", {}, head), ...items);
  }

  // what is drawn of the slider's range
  function windowOf({ knob: { low, high }, here }) {
    const reach = REACH * (high - low);
    return here ? [Math.max(low, here[0] - reach), Math.min(high, here[0] + reach)] : [low, high];
  }

  // uPlot has one row of places for all lines
  function table(lines) {
    const places = [...new Set(lines.flat().map(([x]) => x))].sort((x, y) => x - y);
    return [places, ...lines.map((line) => {
      const values = new Map(line);
      return places.map((x) => values.get(x) ?? null);
    })];
  }

  const plain = (value) => String(Number(value.toPrecision(6))).replace("-", "−");

  function range(u, low, high) {
    const middle = 0.5 * (low + high);
    const half = Math.max(0.6 * (high - low), 1e-3 * Math.abs(middle), 1e-9);
    return [middle - half, middle + half];
  }

  function show(what) {
    const { knob, label, unit, points, a, here, slope } = what;
    if (plot) plot.destroy();
    plot = null;
    const colors = LINES[matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"];
    const [own, tangent] = colors;
    const said = (words, of) => words + (of && of !== "1" ? ` (${of})` : "");
    legend(said(label, unit), [[own, "shown so far"], [tangent, "tangent"]]);
    const [first, last] = windowOf(what);
    const usable = (list) => list.filter((point) => point && point[1] !== null && point[0] >= first && point[0] <= last);
    const ends = usable([here]).length && slope !== null ? [first, last] : [];
    const tangents = ends.map((x) => [x, here[1] + slope * (x - here[0])]);
    const lines = [tangents, usable(points), usable([a]), usable([here])];
    if (!lines.some((line) => line.length)) return;
    const dots = (size, stroke, fill) => ({ paths: () => null, points: { show: true, size, stroke, fill, width: 1.6 } });
    plot = new uPlot({
      width: 100,
      height: 80,
      padding: [6, 10, 0, 0],
      legend: { show: false },
      cursor: { show: false },
      scales: { x: { time: false, range: [first, last] }, y: { range } },
      axes: axesOf(said(knob.label, knob.unit), unit).map((axis) => ({ ...axis, values: (u, marks) => marks.map(plain) })),
      series: [{}, { stroke: tangent, width: 1.6, spanGaps: true, points: { show: false } },
        dots(5, own, own), dots(10, own, "transparent"), dots(9, own, own)],
    }, table(lines), chart);
    plot.over.setAttribute("role", "img");
    plot.over.setAttribute("aria-label", `${said(label, unit)} over ${said(knob.label, knob.unit)}, with the tangent at the present place`);
    fit();
  }

  function fit() {
    const { clientWidth, clientHeight } = chart;
    if (plot && clientWidth && clientHeight) plot.setSize({ width: clientWidth, height: clientHeight });
  }

  new ResizeObserver(fit).observe(panel);
  return { show, drawn: () => plot.data };
}
