// The bodies as objects of three.js: one object for all spheres, one for each shape that has many copies, one for all
// others.

const fewCopies = 3;  // shapes with fewer copies are drawn together
const mostOutlined = 400;  // free bodies with edges; among more of them lines would hide the colours

function floatTexture(width, height) {
  const texture = new THREE.DataTexture(
    new Float32Array(4 * width * height), width, height, THREE.RGBAFormat, THREE.FloatType);
  texture.minFilter = texture.magFilter = THREE.NearestFilter;
  return texture;
}

// The first point at the place of each.
function joinedPoints(points) {
  const step = 1e-5 * points.reduce((size, x) => Math.max(size, Math.abs(x)), 1e-30);
  const keyOf = new Map();
  const same = new Int32Array(points.length / 3);
  for (let p = 0; p < same.length; ++p) {
    const key = [0, 1, 2].map((axis) => Math.round(points[3 * p + axis] / step)).join();
    if (!keyOf.has(key)) keyOf.set(key, p);
    same[p] = keyOf.get(key);
  }
  return same;
}

// Edges between faces that are bent by more than 30 degrees, where the shading shows it too, and borders: pairs of
// corners.
function featureEdges(mesh) {
  const { points, corners, normals } = mesh;
  const same = joinedPoints(points);
  const faces = new Map();
  for (let t = 0; t < corners.length; t += 3) {
    for (let e = 0; e < 3; ++e) {
      const a = same[corners[t + e]];
      const b = same[corners[t + ((e + 1) % 3)]];
      const key = a < b ? a + ":" + b : b + ":" + a;
      if (!faces.has(key)) faces.set(key, [a, b]);
      faces.get(key).push({ t, at: a < b ? [t + e, t + ((e + 1) % 3)] : [t + ((e + 1) % 3), t + e] });
    }
  }
  const normalOf = (t) => {
    const p = [0, 1, 2].map((e) => new THREE.Vector3().fromArray(points, 3 * corners[t + e]));
    return p[1].sub(p[0]).cross(p[2].sub(p[0])).normalize();
  };
  // The normals of both sides at an end; facets of round bodies share them.
  const shaded = (one, two, end) =>
    [0, 1, 2].reduce((sum, k) => sum + normals[3 * one.at[end] + k] * normals[3 * two.at[end] + k], 0) <
    0.97 * 127 * 127;
  const isBent = (one, two) =>
    normalOf(one.t).dot(normalOf(two.t)) < 0.86 && (shaded(one, two, 0) || shaded(one, two, 1));
  const out = [];
  for (const [a, b, ...around] of faces.values()) {
    if (around.length !== 2 || isBent(...around)) out.push(a, b);
  }
  return out;
}

// Lines across the square of a half-space: pairs of points.
function gridLines(square) {
  const corner = (k) => new THREE.Vector3().fromArray(square, 3 * k);
  const parts = 4;
  const u = corner(1).sub(corner(0));
  const v = corner(3).sub(corner(0));
  const out = [];
  for (let k = 1; k < parts; ++k) {
    for (const [across, along] of [[u, v], [v, u]]) {
      const start = corner(0).addScaledVector(across, k / parts);
      out.push(...start.toArray(), ...start.add(along).toArray());
    }
  }
  return out;
}

class Bodies {
  constructor(scene, bodies) {
    this.group = new THREE.Group();
    scene.add(this.group);
    this.bodies = bodies;
    this.width = Math.max(1, Math.min(2048, Math.ceil(Math.sqrt(bodies.n))));
    const height = Math.max(1, Math.ceil(bodies.n / this.width));
    this.places = floatTexture(this.width, height);
    this.turns = floatTexture(this.width, height);
    this.states = floatTexture(this.width, height);
    this.table = new THREE.DataTexture(colourTable("viridis"), 256, 1, THREE.RGBAFormat);
    this.shared = {
      places: { value: this.places },
      turns: { value: this.turns },
      states: { value: this.states },
      table: { value: this.table },
      width: { value: this.width },
      clipPlane: { value: new THREE.Vector4(0, 0, 0, 1e30) },
      wallColour: { value: new THREE.Color() },
      groundColour: { value: new THREE.Color() },
      lifted: { value: 0 },
    };
    this.table.needsUpdate = true;
    for (let k = 0; k < bodies.n; ++k) {
      this.states.image.data[4 * k] = bodies.mesh[k] < 0 ? bodies.radius[k] : bodies.scale[k];
      this.states.image.data[4 * k + 2] = this.isPlane(k) ? 1 : 0;
    }
    this.build();
  }

  // A half-space: of what has no end, rails among them, that which is drawn as a square.
  isPlane(k) {
    const { mesh, meshes, radius } = this.bodies;
    return mesh[k] >= 0 && radius[k] === 0 && meshes[mesh[k]].points.length === 12;
  }

  material(kind, pass, outlined) {
    return new THREE.RawShaderMaterial({
      vertexShader: shaders[kind + "Vertex"], fragmentShader: shaders[kind + "Fragment"],
      uniforms: { ...this.shared, pass: { value: pass }, outlined: { value: outlined ? 1 : 0 } },
      side: THREE.DoubleSide, transparent: pass === 1, depthWrite: pass === 0,
      polygonOffset: !outlined, polygonOffsetFactor: 1, polygonOffsetUnits: 1,  // edges lie before their faces
    });
  }

  // all: the bodies of it
  add(kind, geometry, all) {
    geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e30);
    for (const pass of [0, 1]) {
      const object = new THREE.Mesh(geometry, this.material(kind, pass, false));
      object.frustumCulled = false;
      object.renderOrder = pass;
      object.userData = { pass, all };
      this.group.add(object);
    }
  }

  build() {
    const { n, mesh } = this.bodies;
    const copies = new Map();
    for (let k = 0; k < n; ++k) {
      if (!copies.has(mesh[k])) copies.set(mesh[k], []);
      copies.get(mesh[k]).push(k);
    }
    const loose = [];
    const walls = [];
    const free = [];
    for (const [m, all] of copies) {
      if (m < 0) this.add("sphere", this.squares(all), all);
      else if (all.length >= fewCopies) this.add("mesh", this.copiesOf(m, all), all);
      else loose.push(...all);
      if (m >= 0) for (const k of all) (this.bodies.wall[k] ? walls : free).push(k);
    }
    if (loose.length > 0) this.add("mesh", this.joined(loose), loose);
    this.addEdges(free.length <= mostOutlined ? walls.concat(free) : walls);
  }

  // Four corners for each ball, not copies of one square: SwiftShader sets up a drawing for each copy.
  squares(all) {
    const n = all.length;
    const corners = new Int8Array(16 * n);
    const body = new Float32Array(4 * n);
    const index = new Uint32Array(6 * n);
    for (let k = 0; k < n; ++k) {
      corners.set([-1, -1, 0, 0, 1, -1, 0, 0, -1, 1, 0, 0, 1, 1, 0, 0], 16 * k);
      body.fill(all[k], 4 * k, 4 * k + 4);
      index.set([4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 2, 4 * k + 1, 4 * k + 3], 6 * k);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(corners, 4));
    geometry.setAttribute("body", new THREE.BufferAttribute(body, 1));
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    return geometry;
  }

  // Positions and normals of each corner of a mesh.
  corners(m, positions, normals, at) {
    const mesh = this.bodies.meshes[m];
    for (let c = 0; c < mesh.corners.length; ++c) {
      for (let axis = 0; axis < 3; ++axis) {
        positions[3 * (at + c) + axis] = mesh.points[3 * mesh.corners[c] + axis];
        normals[3 * (at + c) + axis] = mesh.normals[3 * c + axis] / 127;
      }
    }
    return at + mesh.corners.length;
  }

  copiesOf(m, all) {
    const count = this.bodies.meshes[m].corners.length;
    const positions = new Float32Array(3 * count);
    const normals = new Float32Array(3 * count);
    this.corners(m, positions, normals, 0);
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    geometry.setAttribute("body", new THREE.InstancedBufferAttribute(new Float32Array(all), 1));
    geometry.maxInstancedCount = all.length;
    return geometry;
  }

  joined(all) {
    const { meshes, mesh } = this.bodies;
    let count = 0;
    for (const k of all) count += meshes[mesh[k]].corners.length;
    const positions = new Float32Array(3 * count);
    const normals = new Float32Array(3 * count);
    const body = new Float32Array(count);
    let at = 0;
    for (const k of all) {
      const end = this.corners(mesh[k], positions, normals, at);
      body.fill(k, at, end);
      at = end;
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    geometry.setAttribute("body", new THREE.BufferAttribute(body, 1));
    return geometry;
  }

  addEdges(outlined) {
    const positions = [];
    const normals = [];
    const body = [];
    for (const k of outlined) {
      const mesh = this.bodies.meshes[this.bodies.mesh[k]];
      if (mesh.corners.length > 60000) continue;
      for (const p of featureEdges(mesh)) {
        positions.push(mesh.points[3 * p], mesh.points[3 * p + 1], mesh.points[3 * p + 2]);
        normals.push(0, 0, 0);
        body.push(k);
      }
      if (!this.isPlane(k)) continue;
      const grid = gridLines(mesh.points);
      positions.push(...grid);
      for (let p = 0; p < grid.length; p += 3) {
        normals.push(mesh.normals[0], mesh.normals[1], mesh.normals[2]);  // seen from within alone
        body.push(k);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(positions), 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(normals), 3));
    geometry.setAttribute("body", new THREE.BufferAttribute(new Float32Array(body), 1));
    this.edges = [0, 1].map((pass) => {
      const object = new THREE.LineSegments(geometry, this.material("mesh", pass, true));
      object.frustumCulled = false;
      object.renderOrder = 0.5;
      this.group.add(object);
      return object;
    });
  }

  // values: one number in [0, 1] per row, -2 for the colour of walls, -3 for that of the ground.
  show(frame, values) {
    const place = this.places.image.data;
    const turn = this.turns.image.data;
    for (let k = 0; k < this.bodies.n; ++k) place[4 * k + 3] = -1e30;
    for (let row = 0; row < frame.n; ++row) {
      const at = 4 * frame.id[row];
      place[at] = frame.place[3 * row];
      place[at + 1] = frame.place[3 * row + 1];
      place[at + 2] = frame.place[3 * row + 2];
      place[at + 3] = values[row];
      if (frame.turn) for (let part = 0; part < 4; ++part) turn[at + part] = frame.turn[4 * row + part];
      else turn[at + 3] = 1;
    }
    this.places.needsUpdate = this.turns.needsUpdate = true;
  }

  // opacity: of each body; what is left out is not drawn at all.
  showOpacity(opacity) {
    for (let k = 0; k < this.bodies.n; ++k) this.states.image.data[4 * k + 1] = opacity[k];
    this.states.needsUpdate = true;
    for (const object of this.group.children) {
      const { pass, all } = object.userData;
      if (object.isMesh)
        object.visible = all.some((k) =>
          pass === 0 ? opacity[k] > 0.995 : opacity[k] > 0 && (opacity[k] <= 0.995 || this.isPlane(k))
        );
    }
  }

  setTable(bytes) {
    this.table.image.data.set(bytes);
    this.table.needsUpdate = true;
  }

  dispose() {
    for (const object of this.group.children) {
      object.geometry.dispose();
      object.material.dispose();
    }
    for (const texture of [this.places, this.turns, this.states, this.table]) texture.dispose();
    this.group.parent.remove(this.group);
  }
}
