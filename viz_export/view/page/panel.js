// The controls: what the user chooses, and what stands beside the picture.

const el = (id) => document.getElementById(id);
const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => "&#" + c.charCodeAt(0) + ";");

function fillSelect(select, options, chosen) {
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value, false, value === chosen)));
}

function ticksAt(box, range, whole, extremes) {
  box.replaceChildren(
    ...rangeTicks(range, whole, extremes).map((t) => Object.assign(document.createElement("span"), { textContent: t }))
  );
}

// range: null where no body has a value of the field. resting: 98 % are no more than rounding gives; all have one
// colour, as where all are the same. kinds: { name, colour } of those that there are.
function showLegend(field, map, range, resting, kinds) {
  const numbers = field.kind !== "category" && range !== null;
  el("legend-name").textContent =
    field.kind !== "category" && !numbers ? field.label + ": no free bodies" : labelOf(field.label, field.unit);
  el("legend-bar").hidden = el("legend-ticks").hidden = !numbers;
  el("legend-bar").style.display = numbers ? "" : "none";
  el("legend-ticks").style.display = numbers ? "" : "none";
  if (numbers) {
    el("legend-bar").style.background =
      resting || range[0] === range[1] ? css(colourAt(map, onlyShare)) : gradient(map);
    if (resting)
      el("legend-ticks").textContent =
        `${field.name === "residual" ? "rounding" : "at rest"}: 98 % below ${digits(range[1])}`;
    else ticksAt(el("legend-ticks"), range, field.whole, field.extremes);
  }
  const most = 12;
  const named = kinds.length > most ? kinds.slice(0, most - 1) : kinds;
  el("legend-kinds").replaceChildren(...named.map(({ name, colour }) => {
    const row = document.createElement("div");
    const mark = document.createElement("i");
    mark.style.background = css(kindColour(colour));
    row.append(mark, Object.assign(document.createElement("span"), { textContent: name, title: name }));
    return row;
  }));
  if (named.length < kinds.length) el("legend-kinds").append(`and ${kinds.length - named.length} more`);
  if (kinds.length > kindColours.length) el("legend-kinds").append(`; ${kindColours.length} colours, which repeat`);
}

// range: null where there are no contacts.
function showForceLegend(shown, label, range, extremes) {
  const box = el("legend-force");
  box.hidden = !shown;
  box.children[0].textContent = range ? label : "no contacts";
  box.children[1].hidden = box.children[2].hidden = !range;
  if (!range) return;
  box.children[1].style.background = gradient("inferno");
  ticksAt(box.children[2], range, false, extremes);
}

// A row per body name or material: seen or not, and how clear.
function showList(entries, changed) {
  el("list").replaceChildren(
    ...entries.map((entry) => {
      const row = document.createElement("div");
      const seen = Object.assign(document.createElement("input"), {
        type: "checkbox",
        checked: entry.opacity > 0,
        title: "seen",
      });
      const name = Object.assign(document.createElement("span"), { textContent: entry.name, title: entry.name });
      const clear = Object.assign(document.createElement("input"), {
        type: "range",
        min: 0,
        max: 1,
        step: 0.05,
        value: entry.opacity,
        title: "opacity",
      });
      seen.addEventListener("change", () => {
        entry.opacity = seen.checked ? entry.before || 1 : 0;
        clear.value = entry.opacity;
        changed();
      });
      clear.addEventListener("input", () => {
        entry.opacity = entry.before = Number(clear.value);
        seen.checked = entry.opacity > 0;
        changed();
      });
      row.append(seen, name, clear);
      return row;
    })
  );
}

function showPicked(title, rows) {
  el("picked-section").hidden = !title;
  if (!title) return;
  const cells = rows.map(([name, value]) => `<tr><td>${escaped(name)}</td><td>${escaped(value)}</td></tr>`).join("");
  el("picked").innerHTML = `<h2 title="${escaped(title)}">${escaped(title)}</h2><table>${cells}</table>`;
}

function showAxes(camera) {
  const names = ["x", "y", "z"];
  const colours = ["#d55e00", "#009e73", "#0072b2"];
  const turn = camera.quaternion.clone().inverse();
  const ways = names.map((name, k) => {
    const v = new THREE.Vector3().setComponent(k, 1).applyQuaternion(turn);
    return { name, colour: colours[k], x: 34 * v.x, y: -34 * v.y, z: v.z };
  });
  ways.sort((a, b) => a.z - b.z);
  el("axes").innerHTML =
    '<circle r="49"/>' +
    ways
      .map(
        (w) =>
          `<line x2="${w.x}" y2="${w.y}" stroke="${w.colour}" stroke-width="3"/>` +
          `<text x="${1.25 * w.x}" y="${1.25 * w.y + 4}" fill="${w.colour}" text-anchor="middle" ` +
          `font-size="14">${w.name}</text>`
      )
      .join("");
}

// Measures by quantity: each entry is one plot with one quantity on its axis.
function measurePlots(measures) {
  const out = [];
  for (const m of measures) {
    const byUnit = new Map();
    const still = [];  // components without a curve
    for (const c of m.components) {
      if (c.values.every((v) => v === null || v === c.values[0]) && m.components.length > 1) {
        still.push(c.name + (typeof c.values[0] === "number" ? ` = ${digits(c.values[0])}` : ""));
        continue;
      }
      const key = labelOf(c.quantity, c.unit);
      if (!byUnit.has(key)) byUnit.set(key, []);
      byUnit.get(key).push({ label: m.components.length > 1 ? c.name : "", x: c.times || m.times, y: c.values });
    }
    if (byUnit.size === 0 && m.components.length > 0)
      out.push({ name: `${m.name}: nothing changes`, label: "", lines: [], still });
    for (const [label, lines] of byUnit) out.push({ name: `${m.name}: ${label}`, label, lines, still });
  }
  return out;
}
