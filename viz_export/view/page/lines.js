// Contacts, velocities and springs as ribbons that face the eye.

class Ribbons {
  // pointed: with a head at the far end.
  constructor(scene, shared, table, pointed) {
    const corners = pointed
      ? [-1, 0, 0, 1, 0, 0, -1, 0.7, 0, 1, 0.7, 0, -1, 0.7, 1.6, 1, 0.7, 1.6, 0, 1, 0]
      : [-1, 0, 0, 1, 0, 0, -1, 1, 0, 1, 1, 0];
    this.geometry = new THREE.InstancedBufferGeometry();
    this.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(corners), 3));
    this.geometry.setIndex(pointed ? [0, 1, 2, 2, 1, 3, 4, 5, 6] : [0, 1, 2, 2, 1, 3]);
    this.geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e30);
    this.table = new THREE.DataTexture(table, 256, 1, THREE.RGBAFormat);
    this.table.needsUpdate = true;
    const material = new THREE.RawShaderMaterial({
      vertexShader: shaders.lineVertex, fragmentShader: shaders.lineFragment, side: THREE.DoubleSide,
      uniforms: { ...shared, table: { value: this.table } },
    });
    this.object = new THREE.Mesh(this.geometry, material);
    this.object.frustumCulled = false;
    this.object.visible = false;
    scene.add(this.object);
    this.show(0, new Float32Array(0), new Float32Array(0), new Float32Array(0));
  }
  show(n, from, to, sizes) {
    this.geometry.setAttribute("from", new THREE.InstancedBufferAttribute(from, 3));
    this.geometry.setAttribute("to", new THREE.InstancedBufferAttribute(to, 3));
    this.geometry.setAttribute("size", new THREE.InstancedBufferAttribute(sizes, 2));
    this.geometry.maxInstancedCount = n;
    this.object.visible = n > 0;
  }
}

// Width by the square root of the force, so that weak chains are still seen; the widest has `widest` metres each side.
// No ribbon is wider than that part of the smaller body: limitOf tells it of a body.
// residual: the range of its colours, in place of those of the force.
function contactSizes(contacts, strongest, widest, limitOf, residual) {
  const sizes = new Float32Array(2 * contacts.n);
  for (let k = 0; k < contacts.n; ++k) {
    const share = Math.min(1, contacts.force[k] / strongest);
    sizes[2 * k] = Math.min(widest * Math.max(0.06, Math.sqrt(share)), limitOf(contacts.a[k]), limitOf(contacts.b[k]));
    const coloured = residual ? Math.min(1, contacts.residual[k] / residual[1]) : share;
    sizes[2 * k + 1] = 0.15 + 0.75 * coloured;
  }
  return sizes;
}

function showArrows(ribbons, frame, bodies, largest, longest, seen) {
  const rows = [];
  for (let row = 0; row < frame.n; ++row) if (!bodies.wall[frame.id[row]] && seen(frame.id[row])) rows.push(row);
  const from = new Float32Array(3 * rows.length);
  const to = new Float32Array(3 * rows.length);
  const sizes = new Float32Array(2 * rows.length);
  rows.forEach((row, k) => {
    const share = frame.fields.speed[row] / largest;
    for (let axis = 0; axis < 3; ++axis) {
      from[3 * k + axis] = frame.place[3 * row + axis];
      to[3 * k + axis] = from[3 * k + axis] + longest * share * frame.heading[3 * row + axis];
    }
    sizes[2 * k] = 0.035 * longest * Math.min(1, 0.3 + share);
    sizes[2 * k + 1] = Math.min(1, share);
  });
  ribbons.show(rows.length, from, to, sizes);
}

// A zigzag between two straight ends, as in render_run.cpp: its corners, end to end.
function zigzag(from, to, widest) {
  const pieces = 12;
  const straight = 0.15;  // of the length, at each end
  const way = new THREE.Vector3().subVectors(to, from);
  const alongY = Math.abs(way.y) > Math.abs(way.x);
  const side = way
    .clone()
    .cross(new THREE.Vector3(alongY ? 1 : 0, alongY ? 0 : 1, 0))
    .setLength(Math.min(2 * widest, 0.06 * way.length()));
  const corners = [from.clone()];
  for (let k = 0; k <= pieces; ++k) {
    const swing = k % 2 === 0 ? 0 : k % 4 === 1 ? 1 : -1;
    const share = straight + ((1 - 2 * straight) * k) / pieces;
    corners.push(from.clone().addScaledVector(way, share).addScaledVector(side, swing));
  }
  corners.push(to.clone());
  return corners;
}

// A spring to a frame that moves along hangs on a short line.
function springEnds(spring, frame, manifest, bodies, rowOf, width) {
  const a = rowOf(spring.body);
  const b = spring.to === undefined ? -1 : rowOf(spring.to);
  if (a < 0 || (spring.to !== undefined && b < 0)) return null;
  const from = new THREE.Vector3(...spring.attachment);
  if (frame.turn) from.applyQuaternion(new THREE.Quaternion().fromArray(frame.turn, 4 * a));
  from.add(new THREE.Vector3().fromArray(frame.place, 3 * a));
  const up = new THREE.Vector3(...manifest.up);
  const within = bodies.mesh[spring.body] < 0 ? bodies.radius[spring.body] : 0;  // of a ball it would be hidden
  const to =
    b < 0 ? from.clone().addScaledVector(up, 4 * width + within) : new THREE.Vector3().fromArray(frame.place, 3 * b);
  return [from, to];
}

function showSprings(ribbons, frame, manifest, bodies, rowOf, widest) {
  const from = [];
  const to = [];
  const sizes = [];
  for (const spring of manifest.springs) {
    const ends = springEnds(spring, frame, manifest, bodies, rowOf, widest);
    if (!ends || ends[0].equals(ends[1])) continue;
    const corners = zigzag(...ends, widest);
    const width = Math.min(0.35 * widest, 0.008 * ends[0].distanceTo(ends[1]));
    for (let k = 0; k + 1 < corners.length; ++k) {
      from.push(...corners[k].toArray());
      to.push(...corners[k + 1].toArray());
      sizes.push(width, -2);
    }
  }
  ribbons.show(sizes.length / 2, new Float32Array(from), new Float32Array(to), new Float32Array(sizes));
}
