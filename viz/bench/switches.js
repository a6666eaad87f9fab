// buttons that are on or off, by their names

function makeSwitches(bar, entries) {
  const listeners = [];
  const switches = new Map(entries.map((entry) => [entry.name, { ...entry, first: entry.on }]));
  for (const each of switches.values()) {
    each.button = document.createElement("button");
    each.button.type = "button";
    each.button.textContent = each.label;
    each.button.title = `${each.title} (${each.key})`;
    each.button.addEventListener("click", () => set(each.name, !each.on));
    bar.append(each.button);
    show(each);
  }

  function show(each) {
    each.button.setAttribute("aria-pressed", each.on);
    each.apply(each.on);
  }

  function set(name, on) {
    const each = switches.get(name);
    if (!each || each.on === on) return;
    each.on = on;
    show(each);
    listeners.forEach((listener) => listener());
  }

  return {
    all: [...switches.values()],
    isOn: (name) => Boolean(switches.get(name)?.on),
    set,
    toggle: (name) => switches.has(name) && set(name, !switches.get(name).on),
    onChange: (listener) => listeners.push(listener),
    // names of what is other than at first, those that were turned off with a minus
    read: () => [...switches.values()].filter(({ on, first }) => on !== first).map(({ on, name }) => (on ? "" : "-") + name),
    write(names) {
      for (const { name, first } of switches.values())
        set(name, names.includes("-" + name) ? false : names.includes(name) || first);
    },
  };
}
