// where the camera stands, and whether it goes with the body

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
  const middle = stage.position.x;
  const changed = [];
  const state = { view: "three-quarter", held: null }; // x of the world that stays in view while the body runs off
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

  function hold(x) {
    state.held = x;
    keepHeld();
    viewer.set_dirty();
    tell();
  }

  // not by the world's own place, which the animation sets only when its value changes
  function keepHeld() {
    stage.position.x = middle + (state.held === null ? 0 : state.held - world.position.x);
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
    here: () => world.position.x,
    hold,
    follows: data.follows,
    onChange: (listener) => changed.push(listener),
    onTime: keepHeld,
  };
}
