// What the user does with mouse, fingers and keys, and the start of the page.

class Page extends Picker {
  listen() {
    const on = (id, event, f) => el(id).addEventListener(event, f);
    on("time", "input", () => {
      this.play(false);
      this.goTo(Number(el("time").value));
    });
    on("play", "click", () => this.play(!this.playing));
    on("speed", "change", () => this.play(this.playing));
    on("field", "change", () => {
      this.resetRange();
      if (this.picked) this.collect(this.picked, this.field());
    });
    on("map", "change", () => this.showColours());
    for (const id of ["low", "high"]) on(id, "change", () => this.chooseRange());
    on("camera", "change", () => this.place(el("camera").value));
    on("theme", "change", () => this.setTheme());
    on("list-of", "change", () => this.listChanged());
    on("contacts", "change", () => this.showOpacity());
    on("arrows", "change", () => this.showLines());
    on("springs", "change", () => this.showLines());
    on("edges", "change", () => {
      for (const edges of this.bodies.edges) edges.visible = el("edges").checked;
      this.dirty = true;
    });
    for (const id of ["clip", "clip-at"]) {
      on(id, "input", () => {
        this.cutWithView();
        this.dirty = true;
      });
    }
    on("measure", "change", () => this.showFrame());
    on("panel-switch", "click", () => this.togglePanel());
    window.addEventListener("resize", () => this.resize());
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.setTheme());
    this.listenToPointer();
    document.addEventListener("keydown", (e) => this.key(e));
    for (const event of ["change", "click"]) document.addEventListener(event, (e) => this.giveBackKeys(e));
  }

  // Who chose with the mouse means the picture by the next key; who came by the keyboard stays where they are.
  giveBackKeys(e) {
    const done = e.type === "click" ? "button" : "select, [type=checkbox]";
    if (e.target.matches(done) && !e.target.matches(":focus-visible")) e.target.blur();
  }

  togglePanel() {
    document.body.classList.toggle("narrow");
    this.resize();
  }

  // A press that does not move picks.
  listenToPointer() {
    const canvas = el("picture");
    let start = null;
    canvas.addEventListener("pointerdown", (e) => (start = e.isPrimary ? [e.clientX, e.clientY, e.button] : null));
    canvas.addEventListener("pointerup", (e) => {
      const still = start && start[2] === 0 && Math.hypot(e.clientX - start[0], e.clientY - start[1]) < 4;
      start = null;
      if (still && this.frame) this.pickAt(e.clientX, e.clientY);
    });
  }

  key(e) {
    if (["SELECT", "INPUT"].includes(e.target.tagName) && e.target.type !== "range" && e.target.type !== "checkbox")
      return;
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    if (e.key === " " && e.target.matches("[type=checkbox], button")) return;
    const step = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10, Home: -1e9, End: 1e9 }[e.key];
    if (step && e.target.id !== "time" && e.target.type !== "range") {
      this.play(false);
      this.goTo(Math.min(this.source.frames - 1, Math.max(0, this.wanted + step)));
    } else if (e.key === " ") {
      this.play(!this.playing);
    } else if (e.key >= "1" && e.key <= "7") {
      el("camera").value = Object.keys(this.manifest.presets)[Number(e.key) - 1];
      this.place(el("camera").value);
    } else if (e.key === "f") {
      this.place(el("camera").value);
    } else if (e.key === "h") {
      this.togglePanel();
    } else if ({ c: 1, v: 1 }[e.key]) {
      el({ c: "contacts", v: "arrows" }[e.key]).click();
    } else {
      return;
    }
    e.preventDefault();
  }
}

// Until the run has one, or is another.
function waitForFrames(source, viewer) {
  const loadAgain = () => (viewer.anew ? loadAnew() : location.reload());
  setInterval(async () => {
    try {
      await source.readManifest();
    } catch (e) {
      if (!(e instanceof MadeAnew)) return;  // it is written just now, or has gone
      loadAgain();
    }
    if (source.frames > 0) loadAgain();
  }, 1000);
}

async function main() {
  const message = (text) => {
    el("message").hidden = false;
    el("message").textContent = text;
  };
  const source = new Source();
  try {
    if (!source.inside) await source.hasChanged();
    await source.readManifest();
    const viewer = new Page(source);
    window.epafi = viewer;
    if (window.innerWidth <= 760 || window.self !== window.top) document.body.classList.add("narrow");
    viewer.start();
    if (source.frames === 0) {
      message("There is no frame yet.");
      if (!source.inside) waitForFrames(source, viewer);
      return;
    }
    await viewer.goTo(0);
    viewer.draw(0);
    setTimeout(() => viewer.follow(), 1000);
  } catch (e) {
    document.body.classList.add("failed");  // nothing of the page works
    message(e.message);
    throw e;
  }
}

main();
