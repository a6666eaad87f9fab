// numbers that stand in the scene where they belong: forces at their arrows, angles at their joints

function makeLabels(viewer, pane, layer, data, samples) {
  const { Vector3 } = MeshCat.THREE;
  const point = new Vector3();
  const camera = viewer.camera;

  function make(kind) {
    const element = document.createElement("span");
    element.className = kind;
    layer.append(element);
    return element;
  }

  const LINE = 20; // pixels
  const LETTER = 7.4;
  let taken = []; // places of what was put so far: what would lie over another goes above it

  function put(element, text, object, up) {
    point.set(0, 0, up);
    object.localToWorld(point).project(camera);
    const shown = text !== "" && point.z < 1;
    element.hidden = !shown;
    if (!shown) return;
    if (element.textContent !== text) element.textContent = text;
    const x = ((1 + point.x) / 2) * pane.clientWidth;
    let y = ((1 - point.y) / 2) * pane.clientHeight;
    const width = LETTER * text.length + 10;
    while (taken.some((other) => x < other.x + other.width && other.x < x + width && Math.abs(other.y - y) < LINE - 1)) y -= LINE;
    taken.push({ x, y, width });
    element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
  }

  // of the samples, which are exact: arrows go straight from frame to frame
  const arrows = data.arrows.filter(([, toe]) => samples.byName.has(`force_z_${toe}`)).map(([path, toe, share]) => {
    const [whole, shaft, head] = ["", "/shaft", "/head"].map((part) => nodeAt(viewer, path + part).object);
    const columns = ["x", "y", "z"].map((axis) => samples.byName.get(`force_${axis}_${toe}`)).filter(Boolean);
    const element = make("force");
    return (value) => {
      const length = whole.visible ? shaft.scale.z + head.scale.z : 0;
      const newtons = share * Math.hypot(...columns.map(value));
      put(element, length ? `${Math.round(newtons)} N${share < 1 ? " a foot" : ""}` : "", whole, length);
    };
  });
  const joints = data.joints.filter(([name]) => samples.byName.has(`q_${name}`)).map(([name, path]) => {
    const { object } = nodeAt(viewer, path);
    const column = samples.byName.get(`q_${name}`);
    const element = make("angle");
    const said = column.color ? name.split("_").pop() : name; // of four legs, where it stands says which
    return (value) => put(element, `${said} ${value(column).toFixed(2).replace("-", "−")} rad`, object, 0);
  });

  const shown = { forces: false, angles: false };
  const labels = {
    time: 0,
    show(kind, on) {
      shown[kind] = on;
      for (const element of layer.children)
        if (element.className === (kind === "forces" ? "force" : "angle")) element.hidden = true;
      labels.draw();
    },
    // places the numbers where the scene, as it was last drawn or is now, has their objects
    draw() {
      if (!shown.forces && !shown.angles) return;
      viewer.scene.updateMatrixWorld();
      camera.updateMatrixWorld();
      const value = samples.at(labels.time);
      taken = [];
      if (shown.forces) for (const arrow of arrows) arrow(value);
      if (shown.angles) for (const joint of joints) joint(value);
    },
  };
  const render = viewer.render.bind(viewer);
  viewer.render = () => {
    render();
    labels.draw();
  };
  return labels;
}
