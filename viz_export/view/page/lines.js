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
// residual: the range of its colours, in place of those of the force.
function contactSizes(contacts, strongest, widest, residual) {
  const sizes = new Float32Array(2 * contacts.n);
  for (let k = 0; k < contacts.n; ++k) {
    const share = Math.min(1, contacts.force[k] / strongest);
    sizes[2 * k] = widest * Math.max(0.06, Math.sqrt(share));
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

function showSprings(ribbons, frame, manifest, rowOf, width) {
  const from = [];
  const to = [];
  for (const s of manifest.springs) {
    const a = rowOf(s.body);
    const b = s.to === undefined ? -1 : rowOf(s.to);
    if (a < 0) continue;
    const p = new THREE.Vector3().fromArray(frame.place, 3 * a);
    const turned = new THREE.Vector3(...s.attachment);
    if (frame.turn) turned.applyQuaternion(new THREE.Quaternion().fromArray(frame.turn, 4 * a));
    from.push(...p.add(turned).toArray());
    if (b < 0) to.push(...[p.x, p.y, p.z].map((x, axis) => x + 6 * width * manifest.up[axis]));
    else to.push(frame.place[3 * b], frame.place[3 * b + 1], frame.place[3 * b + 2]);
  }
  const n = from.length / 3;
  const sizes = new Float32Array(2 * n);
  for (let k = 0; k < n; ++k) {
    const length = Math.hypot(to[3 * k] - from[3 * k], to[3 * k + 1] - from[3 * k + 1], to[3 * k + 2] - from[3 * k + 2]);
    sizes.set([Math.min(width, 0.02 * length), -2], 2 * k);  // a line, not a post, whatever it holds
  }
  ribbons.show(n, new Float32Array(from), new Float32Array(to), sizes);
}
