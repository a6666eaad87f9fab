// plots over time, one for each kind and unit of the columns that are chosen, with a cursor at the present time

const DRAG = 4; // pixels from which on a click is a drag
const VALUE_EVERY = 80; // ms between values beside a plot while it plays

function makePlots(clock, data, samples, panel) {
  const { duration, spans, start, across = "time (s)" } = data; // what is across, in a word
  let plots = [];
  let chosen = [];
  let theme = "light";
  const changed = [];

  function grouped() {
    const groups = new Map();
    for (const name of chosen) {
      const column = samples.byName.get(name);
      const key = `${column.kind} (${column.unit})`;
      if (!groups.has(key)) groups.set(key, []);
      groups.get(key).push(column);
    }
    return [...groups.values()];
  }

  function draw() {
    for (const plot of plots) plot.destroy();
    plots = panel.hidden ? [] : grouped().map((columns, i, all) =>
      columns[0].plan ? makePlan(columns[0], samples, panel) : new Plot(columns, i + 1 === all.length));
    panel.classList.toggle("empty", !chosen.length);
    fit();
    point(clock.time, true);
  }

  function fit() {
    for (const plot of plots) {
      plot.fit();
      plot.point(clock.time);
    }
  }

  class Plot {
    constructor(columns, last) {
      const { bars } = columns[0]; // of feet on the ground, in place of lines
      this.columns = bars ? [] : columns;
      const style = getComputedStyle(document.documentElement);
      const [soft, line] = ["--soft", "--line"].map((name) => style.getPropertyValue(name).trim());
      const items = bars || columns;
      const colors = items.map(({ color }, i) => color || LINES[theme][i % LINES[theme].length]);
      this.figure = document.createElement("figure");
      this.figure.className = "plot";
      const caption = document.createElement("figcaption");
      const head = document.createElement("span");
      head.textContent = columns[0].kind + (columns[0].unit ? ` (${columns[0].unit})` : "");
      caption.append(head);
      this.values = items.map((column, i) => {
        const item = document.createElement("span");
        const swatch = document.createElement("i");
        swatch.style.background = colors[i];
        const value = document.createElement("output");
        value.setAttribute("aria-live", "off");
        item.title = column.name || column.label;
        item.append(swatch, column.label + " ", ...(bars ? [] : [value]));
        caption.append(item);
        return value;
      });
      this.chart = document.createElement("div");
      this.chart.className = "chart";
      this.figure.append(caption, this.chart);
      panel.append(this.figure);
      const font = "11px system-ui, DejaVu Sans, sans-serif";
      const axis = { stroke: soft, font, labelFont: font, labelSize: 15, labelGap: 0, grid: { stroke: line, width: 1 }, ticks: { show: false } };
      this.plot = new uPlot({
        width: 100,
        height: 60,
        padding: [6, 8, 0, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false, range: [0, duration] }, ...(bars ? { y: { range: [0, bars.length] } } : {}) },
        axes: [
          { ...axis, size: 20, gap: 3, values: (_, ticks) => ticks.map((tick) => Number((start + tick).toFixed(4))),
            ...(last ? { label: across } : {}) },
          { ...axis, size: 46, gap: 4, ...(bars ? { values: (_, ticks) => ticks.map(() => ""), grid: { show: false } } : {}) },
        ],
        series: [{}, ...columns.map((_, i) => ({ stroke: bars ? "transparent" : colors[i], width: 1.5, points: { show: false } }))],
        hooks: { drawClear: [bars ? (plot) => lay(plot, bars, colors) : shade] },
      }, [samples.t, ...columns.map((column) => column.values)], this.chart);
      const { over } = this.plot;
      over.setAttribute("role", "img");
      over.setAttribute("aria-label", `${items.map(({ title, label }) => title || label).join(", ")} over time in s`);
      this.loop = document.createElement("b");
      this.cursor = document.createElement("i");
      over.append(this.loop, this.cursor);
      followPointer(over);
    }

    fit() {
      const { clientWidth, clientHeight } = this.chart;
      if (clientWidth && clientHeight) this.plot.setSize({ width: clientWidth, height: clientHeight });
      this.mark();
    }

    mark() {
      this.loop.hidden = !clock.loop;
      if (!clock.loop) return;
      this.loop.style.left = (100 * clock.loop[0]) / duration + "%";
      this.loop.style.width = (100 * (clock.loop[1] - clock.loop[0])) / duration + "%";
    }

    point(time) {
      this.cursor.style.transform = `translateX(${((100 * time) / duration).toFixed(3)}%)`;
    }

    destroy() {
      this.plot.destroy();
      this.figure.remove();
    }
  }

  // a bar for each time of a foot on the ground, a row for each foot
  function lay({ ctx, bbox }, bars, colors) {
    const row = bbox.height / bars.length;
    bars.forEach(({ spans }, i) => {
      ctx.fillStyle = colors[i];
      for (const [begin, end] of spans)
        ctx.fillRect(bbox.left + (begin / duration) * bbox.width, bbox.top + (i + 0.15) * row,
          Math.max(1, ((end - begin) / duration) * bbox.width), 0.7 * row);
    });
  }

  // domains that stand on the ground, behind the lines
  function shade({ ctx, bbox }) {
    ctx.save();
    ctx.globalAlpha = theme === "dark" ? 0.16 : 0.09;
    for (const [name, begin, end] of spans) {
      if (!/stance|held|pinned/.test(name)) continue;
      ctx.fillStyle = colorOf(name);
      ctx.fillRect(bbox.left + (begin / duration) * bbox.width, bbox.top, ((end - begin) / duration) * bbox.width, bbox.height);
    }
    ctx.restore();
  }

  // a click seeks, a drag loops what it passes
  function followPointer(over) {
    let begun = null;
    const timeAt = (x) => {
      const { left, width } = over.getBoundingClientRect();
      return Math.max(0, Math.min(duration, ((x - left) / width) * duration));
    };
    over.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      begun = event.clientX;
      over.setPointerCapture(event.pointerId);
    });
    over.addEventListener("pointermove", (event) => {
      if (begun === null || Math.abs(event.clientX - begun) < DRAG) return;
      clock.setLoop([timeAt(begun), timeAt(event.clientX)].sort((a, b) => a - b));
    });
    over.addEventListener("pointerup", (event) => {
      if (begun === null) return;
      if (Math.abs(event.clientX - begun) < DRAG) clock.pauseAt(timeAt(event.clientX));
      else if (clock.loop) clock.seek(clock.loop[0]);
      begun = null;
    });
    over.addEventListener("pointercancel", () => (begun = null));
  }

  let told = 0;
  function point(time, surely) {
    if (!plots.length) return;
    for (const plot of plots) plot.point(time);
    const now = performance.now();
    if (clock.playing && !surely && now - told < VALUE_EVERY) return;
    told = now;
    const value = samples.at(time);
    for (const plot of plots) plot.columns.forEach((column, i) => (plot.values[i].textContent = shortly(value(column))));
  }

  const shortly = (number) => !Number.isFinite(number) ? "–" :
    (Math.abs(number) >= 100 ? number.toFixed(0) : Math.abs(number) >= 10 ? number.toFixed(1) : number.toFixed(3))
      .replace(/^-(?=[0.]*$)/, "").replace("-", "−");

  clock.onTime(point);
  clock.onChange(() => plots.forEach((plot) => plot.mark()));
  new ResizeObserver(fit).observe(panel);
  watchTheme((now) => {
    theme = now;
    if (plots.length) draw();
  });
  return {
    names: () => chosen,
    choose(names) {
      chosen = names.filter((name) => samples.byName.has(name));
      draw();
      changed.forEach((listener) => listener());
    },
    draw,
    onChange: (listener) => changed.push(listener),
  };
}
