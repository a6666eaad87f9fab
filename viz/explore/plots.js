// plots over time: B, what is shown, in full lines, and A, what it is compared with, dashed

// what all plots of the page have along their sides
function axesOf(across, up) {
  const style = getComputedStyle(document.documentElement);
  const [soft, line] = ["--soft", "--line"].map((name) => style.getPropertyValue(name).trim());
  const font = "11px system-ui, DejaVu Sans, sans-serif";
  const axis = { stroke: soft, font, labelFont: font, labelSize: 15, labelGap: 0, grid: { stroke: line, width: 1 }, ticks: { show: false } };
  return [{ ...axis, size: 20, gap: 3, label: across }, { ...axis, size: 44, gap: 4, label: up }];
}

function makeComparison(data, panel, clock) {
  const at = { a: null, b: null, theme: "light" };
  let plots = [];

  // values of A at the times of B, none where A has ended
  function onTimes(times, own, values) {
    let i = 0;
    return times.map((time) => {
      while (i + 2 < own.length && own[i + 1] < time) i++;
      if (time > own[own.length - 1] || own.length < 2) return null;
      const span = own[i + 1] - own[i];
      return span > 0 ? values[i] + ((time - own[i]) / span) * (values[i + 1] - values[i]) : values[i + 1];
    });
  }

  class Plot {
    constructor([title, unit, lines]) {
      Object.assign(this, { title, unit, lines, names: Object.keys(lines) });
      this.figure = document.createElement("figure");
      this.figure.className = "plot";
      this.caption = document.createElement("figcaption");
      this.chart = document.createElement("div");
      this.chart.className = "chart";
      this.figure.append(this.caption, this.chart);
      panel.append(this.figure);
    }

    draw() {
      if (this.plot) this.plot.destroy();
      const { a, b } = at;
      const colors = LINES[at.theme];
      const head = document.createElement("span");
      head.textContent = `${this.title} (${this.unit})`;
      this.caption.replaceChildren(head, ...this.names.map((name, i) => {
        const item = document.createElement("span");
        const swatch = document.createElement("i");
        swatch.style.background = colors[i];
        item.append(swatch, this.lines[name]);
        return item;
      }));
      const times = b.series.t;
      const before = a ? this.names.map((name) => onTimes(times, a.series.t, a.series[name])) : [];
      this.plot = new uPlot({
        width: 100,
        height: 80,
        padding: [6, 10, 0, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false, range: [0, b.duration] } },
        axes: axesOf("time (s)", this.unit),
        series: [
          {},
          ...before.map((_, i) => ({ stroke: colors[i], width: 1.2, alpha: 0.65, dash: [4, 4], points: { show: false } })),
          ...this.names.map((_, i) => ({ stroke: colors[i], width: 1.6, points: { show: false } })),
        ],
        hooks: { drawClear: [shade] },
      }, [times, ...before, ...this.names.map((name) => b.series[name])], this.chart);
      const { over } = this.plot;
      over.setAttribute("role", "img");
      const labels = Object.values(this.lines).join(", ");
      over.setAttribute("aria-label", `${this.title} in ${this.unit} over time in s: ${labels}${a ? `; dashed: ${a.name}` : ""}`);
      this.cursor = document.createElement("i");
      over.append(this.cursor);
      const follow = (event) => {
        if (!event.buttons) return;
        const { left, width } = over.getBoundingClientRect();
        clock.pauseAt(((event.clientX - left) / width) * b.duration);
      };
      over.addEventListener("pointerdown", follow);
      over.addEventListener("pointermove", follow);
      this.fit();
    }

    fit() {
      const { clientWidth, clientHeight } = this.chart;
      if (this.plot && clientWidth && clientHeight) this.plot.setSize({ width: clientWidth, height: clientHeight });
    }

    point(time) {
      if (this.cursor) this.cursor.style.transform = `translateX(${((100 * time) / at.b.duration).toFixed(3)}%)`;
    }
  }

  // domains on the ground, behind the lines
  function shade({ ctx, bbox }) {
    const { b } = at;
    ctx.save();
    ctx.globalAlpha = at.theme === "dark" ? 0.16 : 0.09;
    for (const [name, begin, end] of b.spans) {
      if (!name.includes("stance")) continue;
      ctx.fillStyle = colorOf(name);
      ctx.fillRect(bbox.left + (begin / b.duration) * bbox.width, bbox.top, ((end - begin) / b.duration) * bbox.width, bbox.height);
    }
    ctx.restore();
  }

  function point(time) {
    for (const plot of plots) plot.point(time);
  }

  function show(a, b) {
    Object.assign(at, { a, b });
    for (const plot of plots) plot.draw();
    point(clock.time);
  }

  plots = data.plots.map((plot) => new Plot(plot));
  clock.onTime(point);
  new ResizeObserver(() => plots.forEach((plot) => plot.fit())).observe(panel);
  watchTheme((theme) => {
    at.theme = theme;
    if (at.b) show(at.a, at.b);
  });
  return { show };
}
