// the numbers that are turned: a slider and a field each, with a mark where each stood at first

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

// `turn(name, value)` as a slider moves, `enter()` when it has been let go, `refuse(name, text)` of what is not valid,
// `touch(name)` when it gets the focus
function makeSliders(knobs, panel, { turn, enter, refuse, touch }) {
  const sliders = [];

  function build(name) {
    const knob = knobs[name];
    const unit = knob.unit === "1" ? "" : knob.unit;
    const number = make("input", { type: "number", name, id: "number_" + name, min: knob.low, max: knob.high, step: "any" });
    const label = make("label", { for: number.id }, make("span", {}, knob.label), number, make("span", { class: "unit" }, unit));
    const slider = make("input", { type: "range", name, min: knob.low, max: knob.high, step: "any",
      "aria-label": `${knob.label}${unit ? " in " + unit : ""}` });
    const first = Number(knob.default.toFixed(knob.digits));
    const part = (knob.default - knob.low) / (knob.high - knob.low);
    const mark = make("i", { class: knob.origin, style: `left:calc(8px + (100% - 16px) * ${part})` });
    const said = `${ORIGINS[knob.origin]} ${first}, ${knob.note}`;
    const origin = make("button", { type: "button", class: `origin ${knob.origin}`, title: `Back to ${first}`,
      "aria-label": `${said}: ${knob.label} back to it` }, said);
    number.addEventListener("input", () => widen(number));
    slider.addEventListener("input", () => turn(name, Number(Number(slider.value).toFixed(knob.digits))));
    slider.addEventListener("change", enter);
    for (const input of [slider, number]) input.addEventListener("focus", () => touch(name));
    number.addEventListener("keydown", (event) => event.stopPropagation()); // digits are no keys of the page here
    number.addEventListener("change", () => {
      if (!number.value || !number.checkValidity()) return refuse(name, number.value);
      turn(name, Number(number.value));
      enter();
    });
    origin.addEventListener("click", () => (turn(name, knob.default), enter()));
    panel.append(make("div", { class: "knob" }, label, make("div", { class: "track" }, mark, slider), origin,
      make("p", { class: "effect", id: "effect_" + name })));
    sliders.push(slider);
  }
  Object.keys(knobs).forEach(build);

  // a field is as wide as its number; where the browser does not let what is no number be read, as it was
  function widen(number) {
    if (number.value) number.style.width = Math.max(NARROWEST, number.value.length + 2) + "ch";
  }

  return {
    show(values) {
      for (const slider of sliders) {
        const { name } = slider;
        const written = Number(values[name].toFixed(knobs[name].digits));
        for (const input of document.getElementsByName(name)) input.value = written;
        widen(document.getElementById("number_" + name));
        slider.setAttribute("aria-valuetext", `${written} ${knobs[name].unit === "1" ? "" : knobs[name].unit}`.trim());
      }
    },
    enable(name, on) {
      for (const input of document.getElementsByName(name)) input.disabled = !on;
    },
    // puts the focus on the next slider, or the one before
    step(way) {
      const usable = sliders.filter((slider) => !slider.disabled);
      const here = usable.indexOf(document.activeElement);
      const next = here < 0 ? (way > 0 ? 0 : usable.length - 1) : (here + way + usable.length) % usable.length;
      usable[next].focus();
      usable[next].scrollIntoView({ block: "nearest" });
    },
  };
}

const NARROWEST = 8; // digits
const ORIGINS = { source: "source", solved: "solved", assumption: "assumption", scaled: "scaled", own: "at first" };
const ORIGINS_SAID = { source: "the source's", solved: "solved for", assumption: "assumption",
  scaled: "scaled by size", own: "the gait's, or a file's" };
