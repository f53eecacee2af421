// What lies under a point of the picture: the nearest body that is seen, or a contact's line.

function raySphere(origin, direction, centre, radius) {
  const way = new THREE.Vector3().subVectors(centre, origin);
  const along = way.dot(direction);
  const rest = radius * radius - way.lengthSq() + along * along;
  return rest < 0 ? Infinity : along - Math.sqrt(rest);
}

// Distance along the ray to a body's triangles.
function rayMesh(ray, mesh, scale, place, turn) {
  const back = turn.clone().inverse();
  const local = new THREE.Ray(ray.origin.clone().sub(place).applyQuaternion(back).divideScalar(scale),
    ray.direction.clone().applyQuaternion(back));
  const [a, b, c, hit] = [0, 1, 2, 3].map(() => new THREE.Vector3());
  let nearest = Infinity;
  for (let t = 0; t < mesh.corners.length; t += 3) {
    a.fromArray(mesh.points, 3 * mesh.corners[t]);
    b.fromArray(mesh.points, 3 * mesh.corners[t + 1]);
    c.fromArray(mesh.points, 3 * mesh.corners[t + 2]);
    if (local.intersectTriangle(a, b, c, false, hit)) nearest = Math.min(nearest, hit.distanceTo(local.origin) * scale);
  }
  return nearest;
}

function pickBody(ray, frame, bodies, opacity, cut) {
  let best = { distance: Infinity, row: -1 };
  const centre = new THREE.Vector3();
  const turn = new THREE.Quaternion();
  const behindCut = (distance) => {
    if (!cut) return false;
    const p = ray.at(distance, new THREE.Vector3());
    return cut.normal.dot(p) > cut.at;
  };
  for (let row = 0; row < frame.n; ++row) {
    const id = frame.id[row];
    if (opacity[id] < 0.5) continue;
    centre.fromArray(frame.place, 3 * row);
    const m = bodies.mesh[id];
    const reach = bodies.radius[id] > 0 ? bodies.radius[id] : Infinity;
    const ball = reach === Infinity ? 0 : raySphere(ray.origin, ray.direction, centre, reach);
    if (ball >= best.distance || ball === Infinity) continue;
    let distance = ball;
    if (m >= 0) {
      if (frame.turn) turn.fromArray(frame.turn, 4 * row);
      distance = rayMesh(ray, bodies.meshes[m], bodies.scale[id], centre, turn);
    }
    if (distance > 0 && distance < best.distance && !behindCut(distance)) best = { distance, row };
  }
  return best;
}

// The contact whose line passes within `near` metres of the ray.
function pickContact(ray, contacts, near) {
  let best = { distance: Infinity, contact: -1 };
  const [a, b, onRay] = [0, 1, 2].map(() => new THREE.Vector3());
  for (let k = 0; k < contacts.n; ++k) {
    a.fromArray(contacts.from, 3 * k);
    b.fromArray(contacts.to, 3 * k);
    if (ray.distanceSqToSegment(a, b, onRay) > near * near) continue;
    const distance = onRay.distanceTo(ray.origin);
    if (distance < best.distance) best = { distance, contact: k };
  }
  return best;
}
