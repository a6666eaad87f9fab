"use strict";
// meshcat's viewer in a page that drives the time itself

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

function handle(viewer, commands) {
  for (const command of commands) viewer.handle_command_bytearray(bytesOf(command));
  viewer.animator.pause();
}

function openViewer(pane, commands, { horizon, distance }) {
  let viewer;
  try {
    viewer = new MeshCat.Viewer(pane);
  } catch (problem) {
    pane.innerHTML = '<p class="failed">This page needs WebGL, which this browser does not offer.</p>';
    throw problem;
  }
  handle(viewer, commands);
  viewer.scene.fog = new MeshCat.THREE.Fog(horizon, distance * 1.4, distance + 9);
  const sun = viewer.scene_tree.find(["Lights", "FillLight", "<object>"]).object;
  const reach = distance / 2.2;
  Object.assign(sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1, far: 12 });
  sun.shadow.bias = -0.0005;
  viewer.controls.maxPolarAngle = 1.54; // not below the ground
  viewer.controls.maxDistance = 4 * distance;
  return viewer;
}

// the node of the scene at a path such as "/stage/world"
function nodeAt(viewer, path) {
  return viewer.scene_tree.find(path.split("/").filter(Boolean));
}
