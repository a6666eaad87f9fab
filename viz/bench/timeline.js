// the time bar: domains in their colours, events, the loop, and what they are called where the pointer is

function makeTimeline(clock, data, at) {
  const { duration, spans, events, start } = data;
  const percent = (time) => (100 * time) / duration + "%";
  const stops = spans.map(([name, begin, end]) => `${colorOf(name)} ${percent(begin)} ${percent(end)}`);
  at("spans").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  for (const [name, time] of events) {
    const tick = document.createElement("i");
    tick.style.left = percent(time);
    tick.title = name;
    at("spans").append(tick);
  }
  const loop = document.createElement("b");
  at("spans").append(loop);

  const seconds = (time) => (start + time).toFixed(3) + " s";
  const spanAt = (time) => spans.filter((span) => span[1] <= time).pop() || spans[0];
  const scrubber = at("scrubber");
  scrubber.max = duration;
  scrubber.addEventListener("input", () => clock.pauseAt(Number(scrubber.value)));

  const NEAR = 7; // pixels between the pointer and an event
  const tip = at("tip");
  function point(event) {
    const { left, width } = at("spans").getBoundingClientRect();
    const time = ((event.clientX - left) / width) * duration;
    const near = events
      .map(([name, when]) => [Math.abs(when - time) * (width / duration), name, when])
      .filter(([distance]) => distance < NEAR)
      .sort((a, b) => a[0] - b[0])[0];
    const shown = Math.max(0, Math.min(duration, near ? near[2] : time));
    tip.textContent = `${near ? near[1] : spanAt(shown)[0]}, ${seconds(shown)}`;
    const room = tip.parentElement.clientWidth;
    tip.hidden = false;
    const middle = left - tip.parentElement.getBoundingClientRect().left + (shown / duration) * width;
    tip.style.left = Math.max(tip.offsetWidth / 2, Math.min(room - tip.offsetWidth / 2, middle)) + "px";
    tip.classList.toggle("event", Boolean(near));
  }
  at("bar").addEventListener("pointermove", point);
  at("bar").addEventListener("pointerdown", point);
  for (const end of ["pointerleave", "pointercancel"]) at("bar").addEventListener(end, () => (tip.hidden = true));

  let named = "";
  clock.onTime((time) => {
    const [name] = spanAt(time);
    if (name !== named) {
      at("domain").textContent = named = name;
      Object.assign(at("domain").style, { background: colorOf(name), color: inkOn(colorOf(name)) });
    }
    at("time").textContent = seconds(time);
    scrubber.value = time;
    if (!clock.playing) scrubber.setAttribute("aria-valuetext", `${seconds(time)}, ${name}`);
  });
  clock.onChange(() => {
    loop.hidden = !clock.loop;
    if (!clock.loop) return;
    loop.style.left = percent(clock.loop[0]);
    loop.style.width = percent(clock.loop[1] - clock.loop[0]);
  });
  at("total").textContent = "of " + seconds(duration);

  const instants = [0, ...events.map((event) => event[1]), duration];
  return {
    // the next event in a direction, or the end
    beside: (time, way) => (way > 0 ? instants.find((when) => when > time + 1e-6)
      : instants.filter((when) => when < time - 1e-6).pop()) ?? time,
  };
}
