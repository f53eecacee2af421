// What the user picks: a body or a contact, its values at the picture's time and their course.
class Picker extends Follower {
  // x, y: in pixels of the page.
  pickAt(x, y) {
    const area = el("picture").getBoundingClientRect();
    const caster = new THREE.Raycaster();
    caster.setFromCamera(
      new THREE.Vector2((2 * (x - area.left)) / area.width - 1, 1 - (2 * (y - area.top)) / area.height),
      this.camera
    );
    this.picked = this.nextOf(this.choicesOn(caster.ray), x, y);
    this.history = null;
    this.showPick();
    if (this.picked) this.collect(this.picked, this.field());
    return this.picked;
  }

  // What a press may mean, likeliest first: a contact that nothing opaque hides, then bodies.
  choicesOn(ray) {
    const bodies = bodiesUnder(ray, this.frame, this.source.bodies, this.opacity, this.cut());
    const choices = bodies.map((hit) => ({ id: this.frame.id[hit.row] }));
    const shown = el("contacts").checked && this.frame.contacts;
    const hit = shown ? pickContact(ray, this.frame.contacts, 0.4 * this.size) : { contact: -1 };
    const hidden = bodies.some((body) => body.distance < hit.distance && body.opacity > 0.5);
    if (hit.contact >= 0 && !hidden)
      choices.unshift({ a: this.frame.contacts.a[hit.contact], b: this.frame.contacts.b[hit.contact] });
    return choices;
  }
  // A second press at the same place means what lies behind.
  nextOf(choices, x, y) {
    const again = this.pressed && Math.hypot(x - this.pressed[0], y - this.pressed[1]) < 4;
    this.pressed = [x, y];
    const same = (c) => this.picked && c.id === this.picked.id && c.a === this.picked.a && c.b === this.picked.b;
    const before = again ? choices.findIndex(same) : -1;
    return choices[before < 0 ? 0 : (before + 1) % choices.length] || null;
  }
  showPick() {
    if (!this.picked) return showPicked(null);
    return this.picked.id === undefined ? this.showPickedContact() : this.showPickedBody();
  }

  showPickedBody() {
    const id = this.picked.id;
    const bodies = this.source.bodies;
    const row = this.rowOf(id);
    const rows = [["number", id], ["material", this.source.materialName(bodies.material[id])]];
    if (bodies.radius[id] > 0) rows.push(["bounding radius", digits(bodies.radius[id]) + " m"]);
    if (row >= 0) {
      rows.push([
        "position",
        [0, 1, 2]
          .map((k) => digitsTo(this.source.origin[k] + this.frame.place[3 * row + k], this.frame.step))
          .join(", ") + " m",
      ]);
      for (const f of this.manifest.fields) if (f.kind === "moving") rows.push([f.label, this.textOf(row, f)]);
    } else {
      rows.push(["state", "not there at this time"]);
    }
    showPicked(this.source.name(id) + (bodies.wall[id] ? " (wall)" : ""), rows);
    this.showHistory();
    return null;
  }

  textOf(row, field) {
    if (this.frame.broken[field.name]?.has(row)) return "not a number";
    return (
      digitsTo(this.valueOf(this.frame, row, field.name), this.frame.steps[field.name]) +
      (field.unit ? " " + field.unit : "")
    );
  }

  // Its number among the contacts of the frame, -1 where the bodies are apart.
  contactNow(frame) {
    const c = frame.contacts;
    for (let k = 0; c && k < c.n; ++k) if (c.a[k] === this.picked.a && c.b[k] === this.picked.b) return k;
    return -1;
  }

  showPickedContact() {
    const { a, b } = this.picked;
    const k = this.contactNow(this.frame);
    const contacts = this.frame.contacts;
    const rows = [["between", this.source.name(a)], ["and", this.source.name(b)],
      ["normal force", k < 0 ? "apart" : digitsTo(contacts.force[k], contacts.forceStep(k)) + " N"]];
    if (k >= 0 && contacts.residual) rows.push(["residual", digits(contacts.residual[k])]);
    showPicked("contact", rows);
    this.showHistory();
  }

  showHistory() {
    const plot = el("picked-plot");
    if (!this.history) return plot.replaceChildren();
    return drawPlot(plot, [this.history], "time [s]", this.history.axis, this.manifest.times[this.at]);
  }

  // The picked body's field, or the contact's force, over 200 frames at most.
  async collect(picked, field) {
    const history = {
      x: [],
      y: [],
      step: 0,
      axis: picked.id === undefined ? "normal force [N]" : labelOf(field.label, field.unit),
    };
    this.history = history;
    const stride = Math.max(1, Math.ceil(this.source.frames / 200));
    for (let k = 0; k < this.source.frames && this.history === history; k += stride) {
      const frame = await this.source.frame(k);
      const row =
        picked.id === undefined ? -1 : frame.id[picked.id] === picked.id ? picked.id : frame.id.indexOf(picked.id);
      history.x.push(this.manifest.times[k]);
      const contact = picked.id === undefined ? this.contactNow(frame) : -1;
      if (picked.id === undefined) history.y.push(contact < 0 ? null : frame.contacts.force[contact]);
      else history.y.push(row < 0 || frame.broken[field.name]?.has(row) ? null : this.valueOf(frame, row, field.name));
      if (picked.id !== undefined)
        history.step = Math.max(history.step, field.name === "height" ? frame.step : frame.steps[field.name] || 0);
    }
    if (this.history === history) this.showHistory();
  }
}
