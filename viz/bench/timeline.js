// the time bar: domains in their colours, events, the loop, and what they are called where the pointer is

function makeTimeline(clock, at) {
  let { spans, events, start } = { spans: [["", 0, 0]], events: [], start: 0 };
  let named = "";
  const percent = (time) => (100 * time) / clock.duration + "%";
  const seconds = (time) => (start + time).toFixed(3) + " s";
  const spanAt = (time) => spans.filter((span) => span[1] <= time).pop() || spans[0];
  const loop = document.createElement("b");
  loop.hidden = true;

  // the motion of the clock
  function show(motion) {
    ({ spans, events, start } = motion);
    named = "";
    const stops = spans.map(([name, begin, end]) => `${colorOf(name)} ${percent(begin)} ${percent(end)}`);
    at("spans").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    const ticks = events.map(([name, time]) => {
      const tick = document.createElement("i");
      tick.style.left = percent(time);
      tick.title = name;
      return tick;
    });
    at("spans").replaceChildren(...ticks, loop);
    at("total").textContent = "of " + seconds(clock.duration);
  }

  const NEAR = 7; // pixels between the pointer and an event
  const tip = at("tip");
  function point(event) {
    const { duration } = clock;
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

  clock.onTime((time) => {
    const [name] = spanAt(time);
    if (name !== named) {
      at("domain").textContent = named = name;
      Object.assign(at("domain").style, { background: colorOf(name), color: inkOn(colorOf(name)) });
    }
    at("time").textContent = seconds(time);
  });
  clock.onChange(() => {
    loop.hidden = !clock.loop;
    if (!clock.loop) return;
    loop.style.left = percent(clock.loop[0]);
    loop.style.width = percent(clock.loop[1] - clock.loop[0]);
  });

  // the next event in a direction, or the end
  function beside(time, way) {
    const instants = [0, ...events.map((event) => event[1]), clock.duration];
    return (way > 0 ? instants.find((when) => when > time + 1e-6)
      : instants.filter((when) => when < time - 1e-6).pop()) ?? time;
  }

  return {
    show,
    said: (time) => `${seconds(time)}, ${spanAt(time)[0]}`,
    keys: [{ keys: ["Shift+ArrowLeft", "Shift+ArrowRight"], label: "to the event before, after",
      act: (way) => clock.pauseAt(beside(clock.time, way)) }],
  };
}
