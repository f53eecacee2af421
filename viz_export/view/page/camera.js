// The same places as camera.cpp.

const presets = {
  iso: [0.45, -1, 0.5], front: [0, -1, 0], back: [0, 1, 0], left: [-1, 0, 0], right: [1, 0, 0], top: [0, 0, 1], bottom: [0, 0, -1],
};

function fitCamera(camera, controls, box, direction, angle) {
  const towards = new THREE.Vector3(...direction).normalize();
  const target = new THREE.Vector3().addVectors(box.min, box.max).multiplyScalar(0.5);
  camera.up.set(0, Math.abs(towards.z) < 0.999 ? 0 : 1, Math.abs(towards.z) < 0.999 ? 1 : 0);
  const right = new THREE.Vector3().crossVectors(camera.up, towards).normalize();
  const up = new THREE.Vector3().crossVectors(towards, right);
  const high = 0.86 * Math.tan((0.5 * angle * Math.PI) / 180);
  const wide = high * camera.aspect;
  let distance = 1e-12;
  for (let corner = 0; corner < 8; ++corner) {
    const p = new THREE.Vector3(
      corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y, corner & 4 ? box.max.z : box.min.z).sub(target);
    const sideways = Math.max(Math.abs(right.dot(p)) / wide, Math.abs(up.dot(p)) / high);
    distance = Math.max(distance, sideways + towards.dot(p));
  }
  camera.fov = angle;
  camera.position.copy(target).addScaledVector(towards, distance);
  controls.target.copy(target);
  settle(camera, controls);
}

function settle(camera, controls) {
  const size = camera.position.distanceTo(controls.target);
  camera.near = size * 0.005;
  camera.far = size * 60;
  camera.updateProjectionMatrix();
  controls.update();
}

function placeCamera(name, camera, controls, box, view) {
  if (name === "scene" && view.from) {
    camera.up.set(...view.up);
    camera.fov = view.angle;
    camera.position.set(...view.from);
    if (view.to) controls.target.set(...view.to);
    else controls.target.addVectors(box.min, box.max).multiplyScalar(0.5);
    return settle(camera, controls);
  }
  fitCamera(camera, controls, box, presets[name] || presets[view.preset] || presets.iso, view.angle);
}
