// the samples of the trajectory: columns by their names, values at a time, and all of them as a table

function readSamples(packed) {
  const t = new Float64Array(bytesOf(packed.times).buffer);
  const values = new Float32Array(bytesOf(packed.values).buffer);
  let used = 0;
  const columns = packed.columns.map(({ name, label, kind, unit, still }) => {
    const own = still === undefined ? values.subarray(used, (used += t.length)) : new Float32Array(t.length).fill(still);
    return { name, kind, unit, label, values: own, title: unit ? `${name} [${unit}]` : name };
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

  function asCsv(start, spans) {
    const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
    const lines = [["domain", "t [s]", ...columns.map((column) => column.title)].map(quoted).join(",")];
    let span = 0;
    for (let row = 0; row < t.length; row++) {
      // of two samples of one instant the first ends what was before
      const ended = (end) => t[row] > end || (t[row] === end && row > 0 && t[row - 1] === end);
      while (span + 1 < spans.length && ended(spans[span][2])) span++;
      const numbers = columns.map((column) => Number(column.values[row].toPrecision(7)));
      lines.push([quoted(spans[span][0]), start + t[row], ...numbers].join(","));
    }
    return lines.join("\n") + "\n";
  }

  return { t, columns, byName: new Map(columns.map((column) => [column.name, column])), at, asCsv };
}
