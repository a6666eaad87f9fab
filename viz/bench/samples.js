// the samples of the trajectory: columns by their names, values at a time, and all of them as a table

function readSamples(packed) {
  const t = new Float64Array(bytesOf(packed.times).buffer);
  const values = new Float32Array(bytesOf(packed.values).buffer);
  let used = 0;
  const columns = packed.columns.map(({ name, label, kind, unit, heading, still, color }) => {
    const own = still === undefined ? values.subarray(used, (used += t.length)) : new Float32Array(t.length).fill(still);
    return { name, kind, unit, label, color, values: own, title: heading };
  });

  // the last sample that is not after a time
  function rowAt(time) {
    let [low, high] = [0, t.length - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (t[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  // a function that gives a column's value at the time
  function at(time) {
    const row = rowAt(time);
    const next = Math.min(row + 1, t.length - 1);
    const weight = t[next] > t[row] ? (time - t[row]) / (t[next] - t[row]) : 0;
    return (column) => column.values[row] + weight * (column.values[next] - column.values[row]);
  }

  // a function that gives the word at a row, of where each begins
  function wordAt(runs) {
    const words = new Array(t.length);
    runs.forEach(([row, word], i) => words.fill(word, row, i + 1 < runs.length ? runs[i + 1][0] : t.length));
    return (row) => words[row];
  }

  // with the headings and in the order of the tables that Python writes
  function asCsv(start) {
    const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
    const cells = new Map([["t", [packed.time, (row) => start + t[row]]]]);
    for (const { name, title, values } of columns)
      cells.set(name, [title, (row) => Number(values[row].toPrecision(7))]);
    for (const [name, runs] of Object.entries(packed.words)) {
      const word = wordAt(runs);
      cells.set(name, [name, (row) => quoted(word(row))]);
    }
    const shown = packed.order.map((name) => cells.get(name));
    const lines = [shown.map(([title]) => quoted(title)).join(",")];
    for (let row = 0; row < t.length; row++) lines.push(shown.map(([, cell]) => cell(row)).join(","));
    return lines.join("\n") + "\n";
  }

  return { t, columns, byName: new Map(columns.map((column) => [column.name, column])), at, asCsv };
}
