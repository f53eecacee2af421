// Where the page's data come from: its own elements, or the server that gave it. Decoded chunks are kept up to a limit.

const mostKept = 400e6;  // bytes of decoded frames

// What places are counted from: far from the scene's own origin numbers of single precision would not tell bodies
// apart.
function originOf({ min, max }) {
  const centre = min.map((low, axis) => 0.5 * (low + max[axis]));
  const size = Math.hypot(...min.map((low, axis) => max[axis] - low));
  return Math.hypot(...centre) > 100 * size ? centre : [0, 0, 0];
}

class Source {
  constructor() {
    this.manifest = null;
    this.bodies = null;
    this.kept = new Map();  // chunk -> { frames, bytes, promise }
    this.inside = document.getElementById("manifest");
  }
  get frames() {
    return this.manifest.times.length;
  }
  async bytes(name) {
    if (this.inside) return bytesOfBase64(document.getElementById(name).textContent);
    const answer = await fetch(name);
    if (!answer.ok) throw new Error(await answer.text());
    return new Uint8Array(await answer.arrayBuffer());
  }
  async text(name) {
    return new TextDecoder().decode(await this.bytes(name));
  }
  // Since it was asked last.
  async hasChanged() {
    const mark = await this.text("mark");
    const changed = mark !== this.mark;
    this.nextMark = mark;
    return changed;
  }
  async readManifest() {
    const mark = this.nextMark;
    const manifest = JSON.parse(this.inside ? this.inside.textContent : await this.text("manifest"));
    if (this.manifest && manifest.identity !== this.manifest.identity) throw new MadeAnew();
    if (this.manifest && manifest.times.length < this.frames) this.kept.clear();  // resumed from before its last frame
    this.manifest = manifest;
    this.mark = mark;
    this.origin = this.origin || originOf(this.manifest.box);
    if (!this.bodies || this.bodies.n !== this.manifest.bodies) {
      this.bodies = bodiesOf(await inflate(await this.bytes("bodies")));
      return true;
    }
    return false;
  }
  // Of the origin, in a direction.
  along(direction) {
    return direction.reduce((sum, part, axis) => sum + part * this.origin[axis], 0);
  }
  framesIn(chunk) {
    return Math.min(this.manifest.chunk_frames, this.frames - chunk * this.manifest.chunk_frames);
  }
  async frame(k) {
    const size = this.manifest.chunk_frames;
    const chunk = Math.floor(k / size);
    let entry = this.kept.get(chunk);
    if (!entry || entry.frames < this.framesIn(chunk)) {
      const frames = this.framesIn(chunk);
      entry = {
        frames,
        promise: this.bytes("chunk-" + chunk).then((b) => framesOfChunk(b, this.manifest.columns, frames, this.origin)),
      };
      entry.promise.catch(() => this.kept.delete(chunk));
    }
    this.kept.delete(chunk);
    this.kept.set(chunk, entry);  // the last one used stands last
    const decoded = await entry.promise;
    this.forget();
    return decoded[k - chunk * size];
  }
  forget() {
    const most = Math.max(2, Math.floor(mostKept / (this.manifest.chunk_frames * Math.max(1, this.bodies.n) * 60)));
    for (const chunk of this.kept.keys()) {
      if (this.kept.size <= most) break;
      this.kept.delete(chunk);
    }
  }
  name(id) {
    const g = this.manifest.groups[this.groupOf(id)];
    if (!g || !g.name) return "body " + id;
    return g.count > 1 ? g.name + "[" + (id - g.first) + "]" : g.name;
  }
  groupOf(id) {
    const groups = this.manifest.groups;
    for (let g = 0; g < groups.length; ++g)
      if (id >= groups[g].first && id < groups[g].first + groups[g].count) return g;
    return groups.length;
  }
  materialName(k) {
    return this.manifest.materials[k] || "material " + k;
  }
}
