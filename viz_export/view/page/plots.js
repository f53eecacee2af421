// Curves as SVG, with quantity and unit on the axes and a line at the picture's time.

const curveColours = ["#1f77b4", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#332288", "#882255"];

function niceTicks(low, high, wanted) {
  const raw = (high - low) / wanted;
  const size = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * size).find((s) => s >= raw);
  const out = [];
  for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step)
    out.push(Math.abs(v) < 1e-9 * step ? 0 : v);
  return out;
}

// Labels in rows from the left, each with its place: a letter takes 7 at most in the mean.
function legendRows(lines, width) {
  const out = [];
  let [x, row] = [2, 0];
  for (const line of lines) {
    const most = Math.floor((width - 4) / 7);
    const text = line.label.length > most ? line.label.slice(0, most - 1) + "\u2026" : line.label;
    if (x > 2 && x + 7 * text.length > width) [x, row] = [2, row + 1];
    out.push({ text, x, row });
    x += 7 * text.length + 8;
  }
  return out;
}

// lines: [{ label, x, y }]
function drawPlot(svg, lines, xLabel, yLabel, now) {
  const legend = legendRows(lines.filter((line) => line.label), 264);
  const room = legend.length > 0 ? 12 * (1 + legend[legend.length - 1].row) : 0;
  const [w, h, left, right, top, bottom] = [264, 150 + room, 50, 16, 20 + room, 28];
  let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const line of lines) {
    for (let k = 0; k < line.x.length; ++k) {
      if (line.y[k] === null || !isFinite(line.y[k])) continue;
      [x0, x1] = [Math.min(x0, line.x[k]), Math.max(x1, line.x[k])];
      [y0, y1] = [Math.min(y0, line.y[k]), Math.max(y1, line.y[k])];
    }
  }
  // what differs by steps of rounding alone is one value
  const least = 20 * lines.reduce((most, line) => Math.max(most, line.step || 0), 0);
  if (y1 - y0 < least) [y0, y1] = [(y0 + y1 - least) / 2, (y0 + y1 + least) / 2];
  if (!(x1 > x0)) [x0, x1] = [isFinite(x0) ? x0 - 0.5 : 0, isFinite(x0) ? x0 + 0.5 : 1];
  if (!(y1 > y0)) [y0, y1] = isFinite(y0) ? [y0 - (Math.abs(y0) || 1) * 0.1, y0 + (Math.abs(y0) || 1) * 0.1] : [0, 1];
  const px = (x) => left + ((x - x0) / (x1 - x0)) * (w - left - right);
  const py = (y) => h - bottom - ((y - y0) / (y1 - y0)) * (h - top - bottom);
  let out = `<rect class="frame" x="${left}" y="${top}" width="${w - left - right}" height="${h - top - bottom}"/>`;
  for (const t of niceTicks(x0, x1, 4))
    out += `<text x="${px(t)}" y="${h - bottom + 11}" text-anchor="middle">${digits(t)}</text>`;
  const whole = lines.every((line) => line.y.every((v) => v === null || Number.isInteger(v)));
  for (const t of niceTicks(y0, y1, 3).filter((t) => !whole || Number.isInteger(t)))
    out += `<text x="${left - 3}" y="${py(t) + 3}" text-anchor="end">${digits(t)}</text>`;
  out += `<text x="${(left + w - right) / 2}" y="${h - 4}" text-anchor="middle">${xLabel}</text>`;
  out += `<text x="2" y="10">${yLabel}</text>`;
  lines.forEach((line, k) => {
    const colour = curveColours[k % curveColours.length];
    const dash = k < curveColours.length ? "" : ` stroke-dasharray="${2 + 2 * Math.floor(k / curveColours.length)} 2"`;
    let path = "";
    let pen = "M";
    for (let i = 0; i < line.x.length; ++i) {
      if (line.y[i] === null || !isFinite(line.y[i])) {
        pen = "M";
        continue;
      }
      path += pen + px(line.x[i]).toFixed(1) + " " + py(line.y[i]).toFixed(1);
      pen = "L";
    }
    out += `<path d="${path}" fill="none" stroke="${colour}" stroke-width="1.4"${dash}/>`;
    if (!line.label) return;
    const { text, x, row } = legend.shift();
    const title = text === line.label ? "" : `<title>${escaped(line.label)}</title>`;
    out += `<text class="curve" x="${x}" y="${22 + 12 * row}" style="fill:${colour}">${title}${escaped(text)}</text>`;
  });
  if (now >= x0 && now <= x1)
    out += `<line class="now" x1="${px(now)}" x2="${px(now)}" y1="${top}" y2="${h - bottom}"/>`;
  svg.setAttribute("viewBox", `0 0 ${w} ${h}`);
  svg.style.height = h + "px";
  svg.innerHTML = out;
}

const labelOf = (quantity, unit) => (unit ? `${quantity} [${unit}]` : quantity);
