// where the camera stands, and whether it goes, and turns, with the body

const CAMERA_VIEWS = { // directions in the robot's axes: x forward, z up
  "three-quarter": [0.42, -1, 0.17],
  side: [0, -1, 0.03],
  front: [1, 0, 0.03],
  top: [0, -1e-3, 1],
};

function makeCamera(viewer, pane, data) {
  const { camera, controls } = viewer;
  const world = nodeAt(viewer, data.world).object; // goes back as the body goes forward
  const stage = world.parent;
  const middle = stage.position.clone();
  const changed = [];
  // `held`: x, y and angle of the world, as it is seen, that stay while the body runs off
  // `facing`: the angle from which the camera looks on while the body turns; null: it turns with it
  const state = { view: "three-quarter", held: null, facing: null };
  const tell = () => changed.forEach((listener) => listener());

  function place(position, target) {
    camera.position.set(...position);
    controls.target.set(...target);
    controls.update();
    viewer.set_dirty();
  }

  function setView(view) {
    const [x, y, z] = CAMERA_VIEWS[view];
    const scale = data.distance / Math.hypot(x, y, z);
    place([x * scale, z * scale, -y * scale], [0, 0, 0]);
    state.view = view;
    tell();
  }

  // as text: a view's name, or the six numbers of a place and of what is looked at
  function read() {
    const numbers = [...camera.position.toArray(), ...controls.target.toArray()];
    return state.view || numbers.map((number) => Number(number.toFixed(3))).join(",");
  }

  function write(text) {
    const numbers = (text || "").split(",").map(Number);
    if (text in CAMERA_VIEWS) return setView(text);
    if (numbers.length !== 6 || !numbers.every(Number.isFinite)) return;
    place(numbers.slice(0, 3), numbers.slice(3));
    state.view = null;
    tell();
  }

  const angleOf = ({ quaternion }) => 2 * Math.atan2(quaternion.z, quaternion.w);
  const swung = (x, y, angle) => [x * Math.cos(angle) - y * Math.sin(angle), x * Math.sin(angle) + y * Math.cos(angle)];

  // x, y and angle of the world as it is seen
  function here() {
    const swing = state.facing === null ? 0 : state.facing - angleOf(world);
    const { x, y } = world.position;
    return state.held || [...swung(x, y, swing), angleOf(world) + swing];
  }

  function hold(pose) {
    state.held = pose;
    keep();
    viewer.set_dirty();
    tell();
  }

  // the camera turns with the body, or looks on from where it is
  function turn(on) {
    state.facing = on ? null : here()[2];
    keep();
    viewer.set_dirty();
    tell();
  }

  // by the stage around the world: the animation sets the world's own place, and only when that changes
  function keep() {
    const [x, y, angle] = here();
    const swing = angle - angleOf(world);
    const [dx, dy] = swung(world.position.x, world.position.y, swing);
    stage.position.set(middle.x + x - dx, middle.y + y - dy, middle.z);
    stage.quaternion.set(0, 0, Math.sin(swing / 2), Math.cos(swing / 2));
  }

  // the whole robot stays in view, however narrow the pane
  let size = "";
  viewer.set_3d_pane_size = function () {
    const { clientWidth, clientHeight } = pane;
    const first = size === "";
    if (!clientWidth || !clientHeight || size === `${clientWidth} ${clientHeight}`) return;
    size = `${clientWidth} ${clientHeight}`;
    camera.zoom = Math.min(1, clientWidth / clientHeight / data.aspect);
    camera.aspect = clientWidth / clientHeight;
    camera.updateProjectionMatrix();
    viewer.renderer.setSize(clientWidth, clientHeight);
    if (first) viewer.set_dirty();
    else viewer.render(); // a canvas of a new size is empty
  };
  new ResizeObserver(() => viewer.set_3d_pane_size()).observe(pane);
  controls.addEventListener("start", () => {
    state.view = null;
  });
  controls.addEventListener("end", tell);

  return {
    views: Object.keys(CAMERA_VIEWS),
    state,
    setView,
    read,
    write,
    reset() {
      hold(null);
      setView("three-quarter");
    },
    here,
    hold,
    turn,
    follows: data.follows,
    onChange: (listener) => changed.push(listener),
    onTime: keep,
  };
}
