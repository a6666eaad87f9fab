// the list of columns to choose from, by what they are

function makeColumnList(samples, plots, list) {
  const kinds = new Map();
  for (const column of samples.columns) {
    if (!kinds.has(column.kind)) kinds.set(column.kind, []);
    kinds.get(column.kind).push(column);
  }
  const boxes = [];
  for (const [kind, columns] of kinds) {
    const group = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.textContent = kind;
    group.append(legend);
    for (const column of columns) {
      const label = document.createElement("label");
      const box = document.createElement("input");
      box.type = "checkbox";
      box.value = column.name;
      box.addEventListener("change", () => {
        const names = plots.names().filter((name) => name !== box.value);
        plots.choose(box.checked ? [...names, box.value] : names);
      });
      boxes.push(box);
      label.append(box, column.title);
      group.append(label);
    }
    list.append(group);
  }
  const show = () => boxes.forEach((box) => (box.checked = plots.names().includes(box.value)));
  plots.onChange(show);
  show();
}
