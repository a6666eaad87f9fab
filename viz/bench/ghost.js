// another motion of the robot: the shapes of its links once more, translucent, below joints that move otherwise

function addGhost(viewer, { of, path }) {
  (function copy(from, to) {
    for (const [name, child] of Object.entries(from.children)) {
      if (name.startsWith("spring of ")) continue;
      if (name === "<object>") {
        if (child.object.isMesh) to.object.add(faint(child.object));
        continue;
      }
      const node = to.find([name]);
      if (name.startsWith("shape ")) {
        const { position, quaternion, scale } = child.object;
        node.object.position.copy(position);
        node.object.quaternion.copy(quaternion);
        node.object.scale.copy(scale);
      }
      copy(child, node);
    }
  })(nodeAt(viewer, of), nodeAt(viewer, path));
  viewer.set_dirty();

  function faint(mesh) {
    const made = new MeshCat.THREE.Mesh(mesh.geometry, mesh.material.clone());
    Object.assign(made.material, { transparent: true, opacity: 0.28 * mesh.material.opacity, depthWrite: false });
    made.applyMatrix4(mesh.matrix);
    return made;
  }
}
