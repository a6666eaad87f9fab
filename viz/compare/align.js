// how sides go together: all at the same time, in s, or at the same share of their cycles, in cycles

const POINTS = 1500; // of a line

function byTime(sides) {
  const moving = sides.filter((side) => !side.stands);
  return {
    name: "time",
    duration: Math.max(...moving.map((side) => side.duration)),
    rate: 1, // units that pass in a second
    timeOf: (side, x) => x,
    placeOf: (side, time) => time,
    said: (x) => `${x.toFixed(3)} s`,
    title: "over time, in s",
    across: "time (s)",
  };
}

// null where some motion has no whole cycle
function byShare(sides) {
  const moving = sides.filter((side) => !side.stands);
  if (!moving.length || moving.some((side) => side.bounds.length < 2)) return null;
  const cycles = Math.min(...moving.map((side) => side.bounds.length - 1));
  const first = moving[0].bounds;
  return {
    name: "share",
    duration: cycles,
    rate: cycles / (first[cycles] - first[0]), // as fast as the first is in truth
    timeOf(side, x) {
      if (side.stands) return 0;
      const n = Math.min(Math.floor(x), side.bounds.length - 2);
      return side.bounds[n] + (x - n) * (side.bounds[n + 1] - side.bounds[n]);
    },
    placeOf({ bounds }, time) {
      const n = Math.max(0, bounds.findLastIndex((bound, i) => i < bounds.length - 1 && bound <= time));
      return n + (time - bounds[n]) / (bounds[n + 1] - bounds[n]);
    },
    said: (x) => `cycle ${Math.min(cycles, Math.floor(x) + 1)}, ${Math.round(100 * (x - Math.min(cycles - 1, Math.floor(x))))} %`,
    title: "over cycles: at the same share of each",
    across: "cycles",
  };
}

// samples of all sides over one axis, as plots read them: of each column a line for each side
function alignedSamples(sides, alignment) {
  const t = Float64Array.from({ length: POINTS + 1 }, (_, i) => (alignment.duration * i) / POINTS);
  const columns = [];
  for (const name of new Set(sides.flatMap((side) => side.samples.columns.map((column) => column.name)))) {
    const having = sides.filter((side) => side.samples.byName.has(name));
    const { unit, kind } = having[0].samples.byName.get(name);
    for (const side of sides) {
      const own = side.samples.byName.get(name);
      columns.push({ name: `${name} ${side.number}`, of: name, kind: `${name}, ${kind}`, unit, label: side.title, own, side,
        title: `${side.title}: ${name}`, values: own ? line(side, own) : new Array(POINTS + 1).fill(null) });
    }
  }

  function line(side, own) {
    return Array.from(t, (x) => {
      const time = alignment.timeOf(side, x);
      return time > side.duration + 1e-9 ? null : side.samples.at(time)(own);
    });
  }

  const at = (x) => ({ side, own }) => {
    const time = own ? alignment.timeOf(side, x) : NaN;
    return time <= side.duration + 1e-9 ? side.samples.at(time)(own) : NaN;
  };
  return { t, columns, byName: new Map(columns.map((column) => [column.name, column])), at };
}

// of each column the lines of all sides, under its own name
function groupedPlots(plots, sides) {
  const listeners = [];
  const own = (names) => [...new Set(names.map((name) => name.replace(/ \d+$/, "")))];
  plots.onChange(() => listeners.forEach((listener) => listener()));
  return {
    names: () => own(plots.names()),
    choose: (names) => plots.choose(names.flatMap((name) => sides.map((side) => `${name} ${side.number}`))),
    onChange: (listener) => listeners.push(listener),
    draw: plots.draw,
  };
}
