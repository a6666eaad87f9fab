// what the page shows, in its address after #, so that a link shows an instant

const WRITE_AFTER = 250; // ms

function makeAddress(parts, start) {
  const { clock, camera, plots, switches } = parts;
  const decimal = (value) => String(Number(value.toFixed(4)));
  const numbers = (values) => values.map(decimal).join(",");
  // an embedded page has no address of its own
  const own = window.parent === window;

  function text() {
    const held = camera.state.held;
    const fields = {
      t: decimal(start + clock.time),
      play: clock.playing ? "1" : "",
      speed: clock.speed === 1 ? "" : decimal(clock.speed),
      loop: clock.loop ? clock.loop.map((time) => decimal(start + time)).join(",") : "",
      camera: camera.read() === "three-quarter" ? "" : camera.read(),
      held: held === null ? "" : numbers(held.slice(0, held[1] || held[2] ? 3 : 1)),
      show: switches.read().join(","),
      plot: parts.columnsChosen() ? plots.names().join(",") : "",
    };
    const filled = Object.entries(fields).filter(([name, value]) => value !== "" || (name === "plot" && parts.columnsChosen()));
    return "#" + filled.map(([name, value]) => `${name}=${encodeURIComponent(value).replace(/%2C/g, ",")}`).join("&");
  }

  let waiting = 0;
  function write() {
    if (!own) return;
    clearTimeout(waiting);
    waiting = setTimeout(() => history.replaceState(null, "", text()), WRITE_AFTER);
  }

  function read() {
    const fields = new URLSearchParams(location.hash.slice(1));
    const number = (name) => (fields.get(name) ? Number(fields.get(name)) : NaN);
    const held = (fields.get("held") || "").split(",").map((word) => (word ? Number(word) : NaN));
    const { time, playing } = begins();
    switches.write((fields.get("show") || "").split(","));
    if (fields.has("camera")) camera.write(fields.get("camera"));
    if (fields.has("plot")) parts.chooseColumns(fields.get("plot").split(","));
    if (number("speed") > 0) clock.setSpeed(number("speed"));
    const loop = (fields.get("loop") || "").split(",").map(Number);
    clock.setLoop(loop.length === 2 && loop.every(Number.isFinite) ? loop.map((time) => time - start) : null);
    clock.setPlaying(fields.get("play") === "1" || playing);
    clock.seek(time === null ? 0 : time - start);
    if (held.every(Number.isFinite)) camera.hold([...held, 0, 0].slice(0, 3));
    clearTimeout(waiting); // what was read need not be written
  }

  read();
  addEventListener("hashchange", read);
  for (const part of [clock, camera, plots, switches]) part.onChange(write);
  return { text };
}
