// the figures of B, what is shown, and by how much they differ from those of A, what it is compared with

function makeReadouts(readouts, panel) {
  const decimal = (value, digits) => value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
  const multipliers = make("dd", { id: "multipliers" });
  const rows = Object.entries(readouts).map(([name, [label, unit, digits]]) => {
    const figure = make("span", { id: "figure_" + name });
    const change = make("span", { id: "change_" + name, class: "change" });
    panel.append(make("div", {}, make("dt", { title: label }, label), make("dd", {}, figure, " ", change)));
    return { name, unit, digits, figure, change, scale: unit === "%" ? 100 : 1 };
  });
  panel.append(make("div", { class: "wide" }, make("dt", {}, "Multipliers"), multipliers));

  // A is null where there is nothing to compare with
  return function show(a, b) {
    for (const { name, unit, digits, figure, change, scale } of rows) {
      const [value, was] = [b.figures[name], a ? a.figures[name] : null];
      const parts = value === null ? ["–"] : [decimal(scale * value, digits) + " ", make("small", {}, unit)];
      figure.replaceChildren(...parts);
      const both = value !== null && was !== null;
      const difference = both ? decimal(scale * (value - was), digits) : "";
      change.textContent = (Number(difference) > 0 ? "+" : "") + difference;
      change.title = both ? `${decimal(scale * was, digits)} in A` : "";
    }
    panel.title = a ? `small: the difference from ${a.name}` : "";
    const pairs = b.multipliers.filter(([real, imaginary]) => imaginary >= 0 && Math.hypot(real, imaginary) >= 5e-4);
    const texts = pairs.map(([real, imaginary]) => decimal(real, 3) + (imaginary ? ` ± ${decimal(imaginary, 3)}i` : ""));
    multipliers.textContent = texts.join(", ") || "–";
  };
}
