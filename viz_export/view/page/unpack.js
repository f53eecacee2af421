// Reads what pack.cpp and planes.h write: whole numbers as planes of bytes, frames as differences, zlib streams.

async function inflate(bytes) {
  if (bytes.length === 0) return bytes;
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function bytesOfBase64(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; ++k) bytes[k] = raw.charCodeAt(k);
  return bytes;
}

class PlaneReader {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }
  number() {
    const b = this.bytes;
    const at = this.at;
    this.at += 4;
    return (b[at] | (b[at + 1] << 8) | (b[at + 2] << 16) | (b[at + 3] << 24)) >>> 0;
  }
  raw(count) {
    const out = this.bytes.subarray(this.at, this.at + count);
    this.at += count;
    return out;
  }
  planes(count, width) {
    const out = new Uint32Array(count);
    for (let plane = 0; plane < width; ++plane) {
      const from = this.at + plane * count;
      for (let k = 0; k < count; ++k) out[k] |= this.bytes[from + k] << (8 * plane);
    }
    this.at += width * count;
    return out;
  }
  // Differences from `before` where that has as many values, else from row to row.
  differences(count, before, width) {
    const steps = this.planes(count, width);
    const out = new Int32Array(count);
    const byRow = !before || before.length !== count;
    let last = 0;
    for (let k = 0; k < count; ++k) {
      const change = (steps[k] >>> 1) ^ -(steps[k] & 1);
      last = ((byRow ? last : before[k]) + change) | 0;
      out[k] = last;
    }
    return out;
  }
}

function placesOf(steps, n, scales) {
  const out = new Float32Array(3 * n);
  for (let axis = 0; axis < 3; ++axis)
    for (let k = 0; k < n; ++k) out[3 * k + axis] = scales[axis] + scales[3] * steps[axis * n + k];
  return out;
}

// Quaternions x y z w from the largest component's number (of w x y z) and the three others.
function orientationsOf(rest, largest, n) {
  const out = new Float32Array(4 * n);
  const c = [0, 0, 0, 0];
  for (let k = 0; k < n; ++k) {
    let squares = 0;
    let next = 0;
    for (let part = 0; part < 4; ++part) {
      if (part === largest[k]) continue;
      c[part] = (rest[next * n + k] / 511 - 1) / Math.SQRT2;
      squares += c[part] * c[part];
      ++next;
    }
    c[largest[k]] = Math.sqrt(Math.max(0, 1 - squares));
    out.set([c[1], c[2], c[3], c[0]], 4 * k);
  }
  return out;
}

// Unit vectors from an octahedron unfolded to a square.
function headingsOf(steps, n) {
  const out = new Float32Array(3 * n);
  for (let k = 0; k < n; ++k) {
    let x = steps[k] / 127;
    let y = steps[n + k] / 127;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) {
      const folded = (1 - Math.abs(y)) * (x < 0 ? -1 : 1);
      y = (1 - Math.abs(x)) * (y < 0 ? -1 : 1);
      x = folded;
    }
    const length = Math.hypot(x, y, z) || 1;
    out.set([x / length, y / length, z / length], 3 * k);
  }
  return out;
}

// scales[5]: of residuals, 0 where there are none.
function contactsOf(reader, scales) {
  const n = reader.number();
  const a = reader.differences(n, null, 4);
  const b = reader.differences(n, null, 4);
  const root = reader.differences(n, null, 3);
  const ends = reader.differences(6 * n, null, 4);
  const force = new Float32Array(n);
  for (let k = 0; k < n; ++k) force[k] = scales[4] * (root[k] / 65535) ** 2;
  const from = placesOf(ends, n, scales);
  let residual = null;
  if (scales[5] > 0) residual = Float32Array.from(reader.differences(n, null, 3), (r) => scales[5] * (r / 65535) ** 2);
  const way = placesOf(ends.subarray(3 * n), n, [0, 0, 0, scales[3]]);
  for (let k = 0; k < 3 * n; ++k) way[k] += from[k];
  // they are squares of whole steps: the next one is so far
  const forceStep = (k) => scales[4] * ((2 * root[k] + 1) / 65535 ** 2);
  return { n, a, b, force, forceStep, residual, from, to: way };
}

const noNumber = 2 * 65535;  // as pack_columns.cpp writes it

// The frames of a chunk: { n, id, place, turn, fields: {name: values}, heading, contacts }.
// origin: what places are counted from.
async function framesOfChunk(bytes, columns, frames, origin) {
  const head = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const moving = columns.filter((c) => !["id", "position", "rest", "largest", "heading", "contact"].includes(c));
  let at = 4 * columns.length;
  const scales = [];
  for (let k = 0; k < 6 + moving.length; ++k, at += 8) scales.push(head.getFloat64(at, true) - (k < 3 ? origin[k] : 0));
  const readers = {};
  for (let k = 0; k < columns.length; ++k) {
    const size = head.getUint32(4 * k, true);
    readers[columns[k]] = new PlaneReader(await inflate(bytes.subarray(at, at + size)));
    at += size;
  }
  const before = {};
  const next = (name, count, width) => (before[name] = readers[name].differences(count, before[name], width));
  const out = [];
  for (let f = 0; f < frames; ++f) {
    const n = readers.id.number();
    // steps: of what numbers are whole multiples of; broken: rows whose value is no finite number, drawn as 0
    const frame = { n, id: next("id", n, 4), fields: {}, step: scales[3], steps: {}, broken: {} };
    frame.place = placesOf(next("position", 3 * n, 4), n, scales);
    if (readers.rest) frame.turn = orientationsOf(next("rest", 3 * n, 2), readers.largest.raw(n), n);
    moving.forEach((name, k) => {
      const steps = next(name, n, 3);
      const values = new Float32Array(n);
      for (let row = 0; row < n; ++row) {
        if (steps[row] !== noNumber) values[row] = steps[row] * scales[6 + k];
        else (frame.broken[name] ??= new Set()).add(row);
      }
      frame.fields[name] = values;
      frame.steps[name] = scales[6 + k];
    });
    if (readers.heading) frame.heading = headingsOf(next("heading", 2 * n, 2), n);
    if (readers.contact) frame.contacts = contactsOf(readers.contact, scales);
    out.push(frame);
  }
  return out;
}

// Radius, mesh, scale, material and wall of each body, and the meshes.
function bodiesOf(bytes) {
  const whole = (size) => 4 * Math.ceil(size / 4);
  let at = 4;
  const n = new Uint32Array(bytes.slice(0, 4).buffer)[0];
  const column = (Type, count) => {
    const size = count * Type.BYTES_PER_ELEMENT;
    const out = new Type(bytes.slice(at, at + size).buffer);
    at += whole(size);
    return out;
  };
  const out = { n, radius: column(Float32Array, n), mesh: column(Int32Array, n), scale: column(Float32Array, n) };
  out.material = column(Uint16Array, n);
  out.wall = column(Uint16Array, n);
  out.meshes = [];
  const meshes = column(Uint32Array, 1)[0];
  for (let m = 0; m < meshes; ++m) {
    const [points, corners] = column(Uint32Array, 2);
    out.meshes.push({
      points: column(Float32Array, 3 * points),
      corners: column(Uint32Array, corners),
      normals: column(Int8Array, 3 * corners),
    });
  }
  return out;
}
