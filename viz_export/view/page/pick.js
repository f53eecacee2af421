// What lies under a point of the picture: the nearest body that is seen, or a contact's line.

function raySphere(origin, direction, centre, radius) {
  const way = new THREE.Vector3().subVectors(centre, origin);
  const along = way.dot(direction);
  const rest = radius * radius - way.lengthSq() + along * along;
  return rest < 0 ? Infinity : along - Math.sqrt(rest);
}

// Distance along the ray to what is seen of a ball: its surface, or the cut through it.
function rayBall(ray, centre, radius, cut) {
  const front = raySphere(ray.origin, ray.direction, centre, radius);
  if (front === Infinity || !cut || !cut.takes(front)) return front;
  const way = (cut.at - cut.normal.dot(ray.origin)) / cut.normal.dot(ray.direction);
  return way > front && ray.at(way, new THREE.Vector3()).distanceTo(centre) < radius ? way : Infinity;
}

// Distance along the ray to a body's triangles, those that are cut away left out.
function rayMesh(ray, mesh, scale, place, turn, cut) {
  const back = turn.clone().inverse();
  const local = new THREE.Ray(ray.origin.clone().sub(place).applyQuaternion(back).divideScalar(scale),
    ray.direction.clone().applyQuaternion(back));
  const [a, b, c, hit] = [0, 1, 2, 3].map(() => new THREE.Vector3());
  let nearest = Infinity;
  for (let t = 0; t < mesh.corners.length; t += 3) {
    a.fromArray(mesh.points, 3 * mesh.corners[t]);
    b.fromArray(mesh.points, 3 * mesh.corners[t + 1]);
    c.fromArray(mesh.points, 3 * mesh.corners[t + 2]);
    if (!local.intersectTriangle(a, b, c, false, hit)) continue;
    const distance = hit.distanceTo(local.origin) * scale;
    if (distance < nearest && !(cut && cut.takes(distance))) nearest = distance;
  }
  return nearest;
}

// Bodies under the ray, the one that is meant first: all that are drawn, up to the first that hides the others. Walls
// stand about what is looked at: free bodies come before them, then walls by how clear they are. { distance, row,
// opacity }
function bodiesUnder(ray, frame, bodies, opacity, cut) {
  const hits = hitsOf(ray, frame, bodies, opacity, cut).sort((p, q) => p.distance - q.distance);
  const hiding = hits.findIndex((hit) => hit.opacity > 0.995);
  const seen = hiding < 0 ? hits : hits.slice(0, hiding + 1);
  const rank = (hit) => (bodies.wall[frame.id[hit.row]] ? 2 - hit.opacity : 0);
  return seen.sort((p, q) => rank(p) - rank(q) || p.distance - q.distance);
}

function hitsOf(ray, frame, bodies, opacity, cut) {
  const hits = [];
  const centre = new THREE.Vector3();
  const turn = new THREE.Quaternion();
  const normal = new THREE.Vector3();
  const taken = cut && { ...cut, takes: (distance) => cut.normal.dot(ray.at(distance, new THREE.Vector3())) > cut.at };
  for (let row = 0; row < frame.n; ++row) {
    const id = frame.id[row];
    if (!(opacity[id] > 0)) continue;
    centre.fromArray(frame.place, 3 * row);
    const m = bodies.mesh[id];
    const reach = bodies.radius[id] > 0 ? bodies.radius[id] : Infinity;
    const ball = reach === Infinity ? 0 : raySphere(ray.origin, ray.direction, centre, reach);
    if (ball === Infinity) continue;
    let distance = ball;
    let clear = opacity[id];
    if (m >= 0) {
      if (frame.turn) turn.fromArray(frame.turn, 4 * row);
      const away =
        reach === Infinity &&
        bodies.meshes[m].points.length === 12 &&
        normal.fromArray(bodies.meshes[m].normals).applyQuaternion(turn).dot(ray.direction) > 0;
      if (away) clear = Math.min(clear, 0.06);  // a half-space from within
      distance = rayMesh(ray, bodies.meshes[m], bodies.scale[id], centre, turn, taken);
    } else {
      distance = rayBall(ray, centre, reach, taken);
    }
    if (distance > 0 && distance < Infinity) hits.push({ distance, row, opacity: clear });
  }
  return hits;
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
