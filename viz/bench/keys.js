// what each key does, and the list of them

function makeKeys(entries, help, list) {
  for (const { keys, label } of entries) {
    const row = document.createElement("tr");
    const head = document.createElement("th");
    head.scope = "row";
    for (const key of keys) {
      const cap = document.createElement("kbd");
      cap.textContent = { " ": "Space", ArrowLeft: "←", ArrowRight: "→" }[key] || key.replace(/Arrow(Left|Right)/, (_, way) =>
        way === "Left" ? "←" : "→");
      head.append(cap, " ");
    }
    const what = document.createElement("td");
    what.textContent = label;
    row.append(head, what);
    list.append(row);
  }
  const actions = new Map(entries.flatMap(({ keys, act }) => keys.map((key) => [key, act])));

  // what has the focus may want the key for itself
  function wanted(key, { tagName, type }) {
    if (key === " " || key === "Enter") return ["BUTTON", "SUMMARY", "SELECT", "A"].includes(tagName) || type === "checkbox";
    return tagName === "SELECT";
  }

  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || help.open) return;
    const act = actions.get((event.shiftKey && event.key.length > 1 ? "Shift+" : "") + event.key);
    if (!act || wanted(event.key, event.target)) return;
    event.preventDefault();
    act(event.key.includes("Left") || event.key === "," ? -1 : 1);
  });
}
