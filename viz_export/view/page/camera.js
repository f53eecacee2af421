// The same places as camera.cpp, which gives the directions.

// Looking along what is up, the control needs an eye beside the axis: so little that `level` stands upright.
function besideAxis(towards, up, level) {
  const along = towards.dot(up);
  if (Math.abs(along) > 0.999)
    towards.addScaledVector(new THREE.Vector3(...level), -1e-4 * Math.sign(along)).normalize();
  return towards;
}

function fitCamera(camera, controls, box, direction, level, angle) {
  const towards = besideAxis(new THREE.Vector3(...direction).normalize(), camera.up, level);
  const target = new THREE.Vector3().addVectors(box.min, box.max).multiplyScalar(0.5);
  const right = new THREE.Vector3().crossVectors(camera.up, towards).normalize();
  const up = new THREE.Vector3().crossVectors(towards, right);
  const high = 0.86 * Math.tan((0.5 * angle * Math.PI) / 180);
  const wide = high * camera.aspect;
  let distance = 0;
  for (let corner = 0; corner < 8; ++corner) {
    const p = new THREE.Vector3(
      corner & 1 ? box.max.x : box.min.x,
      corner & 2 ? box.max.y : box.min.y,
      corner & 4 ? box.max.z : box.min.z
    ).sub(target);
    const sideways = Math.max(Math.abs(right.dot(p)) / wide, Math.abs(up.dot(p)) / high);
    distance = Math.max(distance, sideways + towards.dot(p));
  }
  camera.fov = angle;
  camera.position.copy(target).addScaledVector(towards, distance > 0 ? distance : 1);
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

// origin: what places are counted from.
function placeCamera(name, camera, controls, box, manifest, origin) {
  const { view, presets, level } = manifest;
  const near = (p) => p.map((v, axis) => v - origin[axis]);
  if (name === "scene" && view.from) {
    camera.fov = view.angle;
    if (view.to) controls.target.set(...near(view.to));
    else controls.target.addVectors(box.min, box.max).multiplyScalar(0.5);
    const way = new THREE.Vector3(...near(view.from)).sub(controls.target);
    const far = way.length();
    camera.position.copy(controls.target).addScaledVector(besideAxis(way.normalize(), camera.up, level), far);
    return settle(camera, controls);
  }
  fitCamera(camera, controls, box, presets[name] || presets[view.preset] || presets.iso, level, view.angle);
}
