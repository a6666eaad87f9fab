// colours of domains and of lines, and of the scene by day and by night

const DOMAIN_COLORS = new Map([["stance", "#2f5fa8"], ["flight", "#7b96ad"], ["posterior stance", "#2f5fa8"],
  ["anterior stance", "#2a8c86"], ["flight 1", "#7b96ad"], ["flight 2", "#93a3b5"],
  ["double stance 1", "#6d5bb0"], ["double stance 2", "#6d5bb0"]]);
const SLIPPING = "#c2873a";
const OTHER_DOMAINS = ["#2a8c86", "#6d5bb0", "#a65f94", "#5c7f4c", "#8a5a40"];
const LINES = { // of Okabe and Ito, darker or lighter where the ground asks for it
  light: ["#0072B2", "#C04D00", "#008060", "#B0508A", "#8A6D00", "#4B4BC8"],
  dark: ["#56B4E9", "#F0883E", "#2DBE95", "#E39AC4", "#E6C229", "#A5A5FF"],
};
const NIGHT = {
  horizon: "#161c22",
  parts: { plane: { color: "#33383d", emissive: "#1b2127" }, minor: { color: "#39434c" }, major: { color: "#4d5964" } },
};
let othersNamed = 0;

function colorOf(domain) {
  if (!DOMAIN_COLORS.has(domain)) {
    const other = OTHER_DOMAINS[othersNamed % OTHER_DOMAINS.length];
    DOMAIN_COLORS.set(domain, domain.includes("slip") ? SLIPPING : other);
    if (!domain.includes("slip")) othersNamed++;
  }
  return DOMAIN_COLORS.get(domain);
}

// black or white, whichever stands out more
function inkOn(color) {
  const linear = [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16) / 255)
    .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  const luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  return luminance > 0.179 ? "#000" : "#fff";
}

// light and dark as the system has it; listeners are told which, at once and when it changes
function watchTheme(listener) {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  dark.addEventListener("change", () => listener(dark.matches ? "dark" : "light"));
  listener(dark.matches ? "dark" : "light");
}

function paintScene(viewer, { horizon, world }) {
  const { Color } = MeshCat.THREE;
  const day = new Map();
  const background = nodeAt(viewer, "/Background");
  watchTheme((theme) => {
    const far = new Color(theme === "dark" ? NIGHT.horizon : horizon);
    for (const end of ["top_color", "bottom_color"]) viewer.set_property(["Background"], end, far.toArray());
    background.on_update();
    viewer.scene.fog.color.copy(far);
    for (const [part, colors] of Object.entries(NIGHT.parts)) {
      const { material } = nodeAt(viewer, `${world}/ground/${part}/<object>`).object;
      for (const [name, color] of Object.entries(colors)) {
        if (!day.has(part + name)) day.set(part + name, material[name].clone());
        material[name].copy(theme === "dark" ? new Color(color) : day.get(part + name));
      }
    }
    viewer.set_dirty();
  });
}
