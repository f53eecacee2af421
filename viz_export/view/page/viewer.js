// Puts the parts together: frames into objects, the user's choices into pictures; it draws when something changed.

// Without a graphics processor every sample is paid for: four per pixel take three times as long.
function drawsInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl && gl.getExtension("WEBGL_debug_renderer_info");
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  if (gl) gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

const paleWall = 0.22;  // opacity

class Viewer {
  constructor(source) {
    this.source = source;
    this.at = -1;
    this.wanted = 0;
    this.frame = null;
    this.picked = null;
    this.playing = false;
    this.dirty = true;
    this.below = false;  // the eye, under the ground
    this.opacities = { body: [], material: [] };
    this.trouble = "";  // of the server
    this.anew = !source.inside && wasMadeAnew() ? "the run was made anew, and this page loaded again" : "";
  }

  get manifest() {
    return this.source.manifest;
  }

  start() {
    const canvas = el("picture");
    const antialias = !drawsInSoftware();
    const context = canvas.getContext("webgl2", { antialias, preserveDrawingBuffer: true });
    if (!context) throw new Error("This browser has no WebGL 2, which this page needs.");
    this.renderer = new THREE.WebGLRenderer({ canvas, context, antialias, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(antialias ? Math.min(window.devicePixelRatio || 1, 2) : 1);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.camera.up.set(...this.manifest.up);  // before the control is made: it turns about what is up then
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.enableKeys = false;
    this.controls.addEventListener("change", () => {
      this.cutWithView();
      this.lookAtGround();
      this.lookForBodies();
      if (this.frame && this.frame.n < 20000) this.countDots();  // of more at the next frame: turning stays smooth
      this.dirty = true;
    });
    const near = (p) => new THREE.Vector3(...p.map((v, axis) => v - this.source.origin[axis]));
    this.box = new THREE.Box3(near(this.manifest.box.min), near(this.manifest.box.max));
    this.makeObjects();
    this.fillPanel();
    this.setTheme();
    this.resize();
    this.place(el("camera").value);
    this.listen();
  }

  makeObjects() {
    if (this.bodies) {
      this.bodies.dispose();
      for (const ribbons of [this.contacts, this.arrows, this.springs]) this.scene.remove(ribbons.object);
    }
    this.bodies = new Bodies(this.scene, this.source.bodies);
    this.contacts = new Ribbons(this.scene, this.bodies.shared, colourTable("inferno"), false);
    this.arrows = new Ribbons(this.scene, this.bodies.shared, colourTable("viridis"), true);
    this.springs = new Ribbons(this.scene, this.bodies.shared, colourTable("viridis"), false);
    this.opacity = new Float32Array(this.source.bodies.n);
    const { radius, wall, n } = this.source.bodies;
    let sum = 0;
    let free = 0;
    for (let k = 0; k < n; ++k) if (!wall[k] && radius[k] > 0) [sum, free] = [sum + radius[k], free + 1];
    this.size = free > 0 ? sum / free : 0.02 * this.box.getSize(new THREE.Vector3()).length();
    this.fillLists();
  }

  fillLists() {
    const m = this.manifest;
    const bodies = this.source.bodies;
    this.grounds = new Set(m.grounds);
    const walls = new Set();
    const hiding = new Set();  // with walls through which what they hold must be seen
    const free = new Set();
    this.groupOf = new Uint32Array(bodies.n);
    for (let k = 0; k < bodies.n; ++k) {
      this.groupOf[k] = this.source.groupOf(k);
      if (this.groupOf[k] === m.groups.length && bodies.wall[k]) ++this.groupOf[k];
      (bodies.wall[k] ? walls : free).add(this.groupOf[k]);
      if (bodies.wall[k] && !this.grounds.has(k)) hiding.add(this.groupOf[k]);
    }
    const names = m.groups.map((g) => g.name || "bodies " + g.first + " to " + (g.first + g.count - 1));
    names.push(m.groups.length > 0 ? "other bodies" : "bodies", "walls");
    this.materials = new Set(bodies.material);  // that there are
    const materials = 1 + bodies.material.reduce((a, b) => Math.max(a, b), 0);
    const before = this.opacities;
    this.opacities = {
      body: names.map((name, k) => (before.body[k] && before.body[k].name === name ? before.body[k]
        : { name, opacity: hiding.has(k) && !free.has(k) && free.size > 0 ? paleWall : 1 })),
      material: Array.from({ length: materials },
        (_, k) => before.material[k] || { name: this.source.materialName(k), opacity: 1 }),
    };
    this.present = new Set([...walls, ...free]);
    this.listChanged();
  }

  listChanged() {
    const kind = el("list-of").value;
    const entries = this.opacities[kind].filter((_, k) => (kind === "material" ? this.materials : this.present).has(k));
    showList(entries, () => this.showOpacity());
    this.showOpacity();
  }

  showOpacity() {
    const bodies = this.source.bodies;
    const chains = el("contacts").checked && this.manifest.strongest > 0 ? 0.16 : 1;
    for (let k = 0; k < bodies.n; ++k) {
      const own = this.opacities.body[this.groupOf[k]].opacity * this.opacities.material[bodies.material[k]].opacity;
      this.opacity[k] = own * (!bodies.wall[k] ? chains : this.below && this.grounds.has(k) ? paleWall : 1);
    }
    this.bodies.showOpacity(this.opacity);
    if (this.frame) this.showLines();
    this.dirty = true;
  }

  isGround(id) {
    return !this.below && this.grounds.has(id);
  }

  // Seen from below, what is solid ground from above would hide all.
  lookAtGround() {
    const { ground_top: top, up } = this.manifest;
    const height = this.camera.position.dot(new THREE.Vector3(...up)) + this.source.along(up);
    const below = top !== undefined && height <= top;
    if (below === this.below) return;
    this.below = below;
    this.showOpacity();
    if (this.frame) this.showFrame();
  }

  fillPanel() {
    const m = this.manifest;
    el("title").textContent = m.title;
    const isField = m.fields.some((f) => f.name === m.view.field);
    fillSelect(el("field"), m.fields.map((f) => [f.name, f.label]), isField ? m.view.field : m.fields[0].name);
    fillSelect(el("map"), Object.keys(polynomials).map((name) => [name, name]), "viridis");
    const cameras = Object.keys(m.presets).map((name, k) => [name, `${name} (${k + 1})`]);
    const views = m.view.from ? [["scene", "of the scene"], ...cameras] : cameras;
    fillSelect(el("camera"), views, m.view.from ? "scene" : m.view.preset || "iso");
    el("contacts").disabled = !m.columns.includes("contact");
    el("arrows").disabled = !m.columns.includes("heading");
    el("springs").disabled = m.springs.length === 0;
    el("springs").checked = m.springs.length > 0;
    this.resetRange();
    this.fillMeasures();
    this.manifestChanged();
  }

  fillMeasures() {
    const chosen = el("measure").value;
    this.plots = measurePlots(this.manifest.measures);
    el("measure-section").hidden = this.plots.length === 0;
    fillSelect(el("measure"), this.plots.map((p) => [p.name, p.name]), chosen);
  }

  manifestChanged() {
    el("time").max = Math.max(0, this.source.frames - 1);
    const last =
      this.manifest.times.length > 0 ? timeText(this.manifest.times, this.manifest.times[this.source.frames - 1]) : "0";
    const running = this.source.inside
      ? `the run went on, at t = ${last} s, when this page was written`
      : `the run goes on: ${this.source.frames} frames until t = ${last} s; End goes to the last one and follows`;
    el("notes").textContent = [
      ...[this.anew, this.blind, this.dots, this.outside].filter((note) => note),
      ...this.manifest.notes,
      ...(this.manifest.cut ? [this.manifest.cut] : []),
      ...(this.trouble ? [this.trouble] : this.manifest.running ? [running] : []),
    ].join("\n");
    el("notes").classList.toggle("cut", this.manifest.cut !== undefined);
  }

  field() {
    return this.manifest.fields.find((f) => f.name === el("field").value) || this.manifest.fields[0];
  }

  resetRange() {
    const field = this.field();
    this.range = field.range ? [...field.range] : null;
    this.chosenRange = false;
    el("low").disabled = el("high").disabled = field.kind === "category" || !field.range;
    this.showRange();
    this.showColours();
  }
  showRange() {
    for (const [id, end] of [["low", 0], ["high", 1]])
      el(id).value = this.range && this.field().kind !== "category" ? Number(this.range[end].toPrecision(4)) : "";
    el("range-note").hidden = true;
  }
  // What stands in the two boxes, where it is a range; an empty box means the end of the data.
  chooseRange() {
    const own = this.field().range;
    const [low, high] = ["low", "high"].map((id, end) => (el(id).value === "" ? own[end] : Number(el(id).value)));
    const fits = low < high || (low === own[0] && high === own[1]);
    el("range-note").hidden = fits;
    el("range-note").textContent =
      `"from" must be less than "to": the colours still go from ${digits(this.range[0])} to ${digits(this.range[1])}`;
    if (!fits) return;
    this.range = [low, high];
    this.chosenRange = el("low").value !== "" || el("high").value !== "";
    this.showRange();
    this.showColours();
  }

  showColours() {
    const field = this.field();
    const kinds = field.kind !== "category" ? [] : field.name === "material"
      ? this.opacities.material.map((e, k) => ({ name: e.name, colour: k })).filter((e) => this.materials.has(e.colour))
      : this.opacities.body.filter((_, k) => this.present.has(k)).map((e, k) => ({ name: e.name, colour: k }));
    showLegend(field, el("map").value, this.range, this.resting(), kinds);
    this.bodies.setTable(colourTable(el("map").value, field.kind === "category"));
    if (this.frame) this.showFrame();
  }

  // Of the field 98 % are no more than rounding gives, and nobody has asked for a range.
  resting() {
    return this.field().resting === true && !this.chosenRange;
  }

  // The field's number of a body of the frame.
  valueOf(frame, row, name) {
    const bodies = this.source.bodies;
    const id = frame.id[row];
    if (frame.fields[name]) return frame.fields[name][row];
    const up = this.manifest.up;
    if (name === "height")
      return up.reduce((sum, part, axis) => sum + part * frame.place[3 * row + axis], this.source.along(up));
    if (name === "size") return bodies.radius[id];
    if (name === "material") return bodies.material[id];
    return name === "body" ? this.groupOf[id] : id;
  }

  shares(frame) {
    const field = this.field();
    const [low, high] = this.resting() ? [0, 0] : this.range || [0, 0];
    const out = new Float32Array(frame.n);
    const kindOf = [];
    if (field.name === "body") [...this.present].sort((a, b) => a - b).forEach((g, k) => (kindOf[g] = k));
    for (let row = 0; row < frame.n; ++row) {
      const value = this.valueOf(frame, row, field.name);
      if (field.kind === "category") out[row] = (field.name === "body" ? kindOf[value] : value) % 256 / 255;
      else if (this.source.bodies.wall[frame.id[row]]) out[row] = this.isGround(frame.id[row]) ? -3 : -2;
      else out[row] = high > low ? Math.min(1, Math.max(0, (value - low) / (high - low))) : onlyShare;
    }
    return out;
  }

  async goTo(k) {
    this.wanted = k;
    if (this.loading) return;
    this.loading = true;
    try {
      while (this.at !== this.wanted) {
        const next = this.wanted;
        this.frame = await this.source.frame(next);
        this.at = next;
        this.showFrame();
      }
      this.tell("");
    } catch (e) {
      this.play(false);
      this.wanted = this.at;
      if (this.at < 0) throw e;
      el("time").value = this.at;  // where the picture is
      this.tell(troubleOf(e));
    } finally {
      this.loading = false;
    }
  }

  // What keeps new frames away; "": nothing.
  tell(trouble) {
    if (trouble === this.trouble) return;
    this.trouble = trouble;
    this.manifestChanged();
  }

  showFrame() {
    this.bodies.show(this.frame, this.shares(this.frame));
    this.showLines();
    const time = this.manifest.times[this.at];
    el("time").value = this.at;
    this.countOutside();
    this.lookForBodies();
    this.countDots();
    el("clock").textContent = `t = ${timeText(this.manifest.times, time)} s`;
    this.showMeasure();
    this.showPick();
    this.dirty = true;
  }

  // Free bodies of which no part is in the box that cameras are placed by.
  countOutside() {
    const { radius, wall } = this.source.bodies;
    const place = new THREE.Vector3();
    let n = 0;
    for (let row = 0; row < this.frame.n; ++row) {
      const id = this.frame.id[row];
      if (!wall[id] && this.box.distanceToPoint(place.fromArray(this.frame.place, 3 * row)) > radius[id]) ++n;
    }
    const text = n > 0 ? `${n} ${n > 1 ? "bodies" : "body"} outside the picture` : "";
    if (text === (this.outside || "")) return;
    this.outside = text;
    this.manifestChanged();
  }

  // A camera that shows no free body says so: it looks elsewhere.
  lookForBodies() {
    if (!this.frame) return;
    const { radius, wall } = this.source.bodies;
    this.camera.updateMatrixWorld();
    const seen = new THREE.Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
    const view = new THREE.Frustum().setFromMatrix(seen);
    const ball = new THREE.Sphere();
    let free = 0;
    let shown = false;
    for (let row = 0; row < this.frame.n && !shown; ++row) {
      const id = this.frame.id[row];
      if (wall[id]) continue;
      ++free;
      ball.center.fromArray(this.frame.place, 3 * row);
      ball.radius = radius[id];
      shown = view.intersectsSphere(ball);
    }
    const text = free > 0 && !shown ? "the camera sees no body: the keys 1 to 7 are other cameras" : "";
    if (text === (this.blind || "")) return;
    this.blind = text;
    this.manifestChanged();
  }

  // Most bodies are dots and cover little of the picture: they stand far apart; as dots_text in render_run.cpp.
  countDots() {
    if (!this.frame) return;
    const { radius, wall } = this.source.bodies;
    this.camera.updateMatrixWorld();
    const height = el("picture").clientHeight;
    const pixel = (2 * Math.tan((this.camera.fov * Math.PI) / 360)) / height; // at distance one
    const place = new THREE.Vector3();
    let shown = 0;
    let dots = 0;
    let covered = 0;
    for (let row = 0; row < this.frame.n; ++row) {
      const id = this.frame.id[row];
      const depth = -place.fromArray(this.frame.place, 3 * row).applyMatrix4(this.camera.matrixWorldInverse).z;
      if (wall[id] || !(radius[id] > 0) || !(depth > 0)) continue;
      const size = radius[id] / (pixel * depth);
      shown += 1;
      if (size < 0.5) dots += 1;
      covered += Math.PI * size * size;
    }
    const few = 2 * dots > shown && !(covered > 1e-3 * height * el("picture").clientWidth);
    const text = few ? `${dots} of ${shown} bodies ${dots === 1 ? "is" : "are"} smaller than a pixel here` : "";
    if (text === (this.dots || "")) return;
    this.dots = text;
    this.manifestChanged();
  }

  showMeasure() {
    if (this.plots.length === 0) return;
    const plot = this.plots.find((p) => p.name === el("measure").value) || this.plots[0];
    el("measure-still").textContent =
      plot.still && plot.still.length > 0 ? "without a curve, as they do not change: " + plot.still.join(", ") : "";
    drawPlot(el("measure-plot"), plot.lines, "time [s]", plot.label, this.manifest.times[this.at]);
  }

  rowOf(id) {
    if (this.frame.id[id] === id) return id;
    return this.frame.id.indexOf(id);
  }

  showLines() {
    const strongest = this.manifest.strongest;
    const contacts = el("contacts").checked && this.frame.contacts;
    const none = new Float32Array(0);
    const residual =
      contacts && contacts.residual && this.field().name === "residual" && this.range ? this.range : null;
    const { radius, wall } = this.source.bodies;
    const limitOf = (id) => (!wall[id] && radius[id] > 0 ? 0.42 * radius[id] : Infinity);
    if (contacts) {
      const sizes = contactSizes(contacts, strongest || 1, 0.42 * this.size, limitOf, residual);
      this.contacts.show(contacts.n, contacts.from, contacts.to, sizes);
    }
    else this.contacts.show(0, none, none, none);
    const forces = strongest > 0 ? [0, strongest] : null;
    if (residual) showForceLegend(contacts, "residual of a contact", residual, null);
    else showForceLegend(contacts, "contact force [N]", forces, [0, this.manifest.strongest_of_all]);
    const speed = (this.manifest.fields.find((f) => f.name === "speed").range || [0, 0])[1];
    if (el("arrows").checked && this.frame.heading && speed > 0)
      showArrows(this.arrows, this.frame, this.source.bodies, speed, 8 * this.size, (id) => this.opacity[id] > 0);
    else this.arrows.show(0, none, none, none);
    const rowOf = (id) => this.rowOf(id);
    if (el("springs").checked)
      showSprings(this.springs, this.frame, this.manifest, this.source.bodies, rowOf, 0.25 * this.size);
    else this.springs.show(0, none, none, none);
    this.dirty = true;
  }

  place(name) {
    placeCamera(name, this.camera, this.controls, this.box, this.manifest, this.source.origin);
    this.lookAtGround();
    this.lookForBodies();
    this.dirty = true;
  }

  // The cut in axes of the world: { normal, at }; null without one.
  cut() {
    const axis = el("clip").value;
    if (!axis) return null;
    const share = Number(el("clip-at").value);
    const { min, max } = this.box;
    if (axis === "view") {
      const normal = new THREE.Vector3().subVectors(this.camera.position, this.controls.target).normalize();
      const half = 0.5 * max.distanceTo(min);
      return { normal, at: normal.dot(this.controls.target) + half * (1 - 2 * share) };
    }
    const k = "xyz".indexOf(axis);
    const sign = axis === "y" ? -1 : 1;
    const place = min.getComponent(k) + (max.getComponent(k) - min.getComponent(k)) * share;
    return { normal: new THREE.Vector3().setComponent(k, sign), at: sign * place };
  }

  cutWithView() {
    const cut = this.cut();
    const plane = this.bodies.shared.clipPlane.value;
    if (!cut) return plane.set(0, 0, 0, 1e30);
    this.camera.updateMatrixWorld();
    const rotation = new THREE.Matrix3().setFromMatrix4(this.camera.matrixWorldInverse);
    const normal = cut.normal.clone().applyMatrix3(rotation);
    const point = cut.normal.clone().multiplyScalar(cut.at).applyMatrix4(this.camera.matrixWorldInverse);
    plane.set(normal.x, normal.y, normal.z, normal.dot(point));
    this.dirty = true;
    return plane;
  }

  setTheme() {
    const chosen = el("theme").value;
    const dark = chosen ? chosen === "dark" : window.matchMedia("(prefers-color-scheme: dark)").matches;
    document.documentElement.classList.toggle("dark", dark);
    this.renderer.setClearColor(dark ? 0x14171c : 0xf7f8fa, 1);
    this.bodies.shared.lifted.value = dark ? 1 : 0;
    this.bodies.shared.wallColour.value.setRGB(...(dark ? [0.5, 0.54, 0.6] : [0.7, 0.73, 0.78]));
    this.bodies.shared.groundColour.value.setRGB(...(dark ? [0.3, 0.33, 0.38] : [0.86, 0.88, 0.9]));
    this.dirty = true;
  }

  resize() {
    const panel = document.body.classList.contains("narrow") || window.innerWidth <= 760 ? 0 : 292;
    const w = Math.max(50, window.innerWidth - panel);
    const h = Math.max(50, window.innerHeight - 44);
    const canvas = el("picture");
    canvas.style.width = w + "px";
    canvas.style.height = h + "px";
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / h;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  play(on) {
    this.playing = on && this.source.frames > 1;
    el("play").innerHTML = this.playing ? "&#10074;&#10074;" : "&#9654;";
    this.clock = null;
  }

  // At speed 1 the whole run takes 8 seconds, or a frame each refresh where that is quicker.
  advance(now) {
    if (!this.playing) return;
    const pace = (Number(el("speed").value) * this.source.frames) / 8000;
    if (this.clock === null) [this.clock, this.from] = [now, this.at >= this.source.frames - 1 ? 0 : this.at];
    const k = Math.floor(this.from + (now - this.clock) * pace);
    if (k >= this.source.frames) {
      [this.clock, this.from] = [now, 0];
      return;
    }
    if (k !== this.wanted && !this.loading) this.goTo(k);
  }

  draw(now) {
    this.advance(now);
    if (this.dirty && this.frame) {
      this.dirty = false;
      this.renderer.render(this.scene, this.camera);
      this.drawn = (this.drawn || 0) + 1;
      showAxes(this.camera);
      document.body.dataset.ready = "true";
    }
    requestAnimationFrame((t) => this.draw(t));
  }
}
