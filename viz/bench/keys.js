// what each key does, and the list of them, that a key and a button open

function makeKeys(own, at) {
  const help = at("help");
  const open = () => help.showModal();
  at("keys").addEventListener("click", open);
  const entries = [...own, { keys: ["?"], label: "this list", act: open }];
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
    at("keylist").append(row);
  }
  const actions = new Map(entries.flatMap(({ keys, act }) => keys.map((key) => [key, act])));

  // what has the focus may want the key for itself; the time's own slider goes as the keys do
  function wanted(key, { tagName, type, id }) {
    if (key === " " || key === "Enter") return ["BUTTON", "SUMMARY", "SELECT", "A"].includes(tagName) || type === "checkbox";
    if (["range", "radio"].includes(type) && id !== "scrubber") return /^(Arrow|Home|End)/.test(key);
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
