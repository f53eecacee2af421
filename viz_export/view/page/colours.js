// The same colours as colours.h, as tables of 256.

const polynomials = {
  viridis: [
    [0.2777273272234177, 0.005407344544966578, 0.3340998053353061],
    [0.1050930431085774, 1.404613529898575, 1.384590162594685],
    [-0.3308618287255563, 0.214847559468213, 0.09509516302823659],
    [-4.634230498983486, -5.799100973351585, -19.33244095627987],
    [6.228269936347081, 14.17993336680509, 56.69055260068105],
    [4.776384997670288, -13.74514537774601, -65.35303263337234],
    [-5.435455855934631, 4.645852612178535, 26.3124352495832],
  ],
  inferno: [
    [0.0002189403691192265, 0.001651004631001012, -0.01948089843709184],
    [0.1065134194856116, 0.5639564367884091, 3.932712388889277],
    [11.60249308247187, -3.972853965665698, -15.9423941062914],
    [-41.70399613139459, 17.43639888205313, 44.35414519872813],
    [77.162935699427, -33.40235894210092, -81.80730925738993],
    [-71.31942824499214, 32.62606426397723, 73.20951985803202],
    [25.13112622477341, -12.24266895238567, -23.07032500287172],
  ],
  grey: [
    [0.2, 0.2, 0.2],
    [0.75, 0.75, 0.75],
  ],
};
const onlyShare = 0.5;  // of the map: where there is one value
const kindColours = [
  [0.0, 0.45, 0.7],
  [0.9, 0.62, 0.0],
  [0.0, 0.62, 0.45],
  [0.8, 0.47, 0.65],
  [0.34, 0.71, 0.91],
  [0.84, 0.37, 0.0],
  [0.94, 0.89, 0.26],
  [0.6, 0.6, 0.6],
  [0.0, 0.18, 0.38],
  [0.45, 0.31, 0.0],
  [0.0, 0.35, 0.15],
  [0.42, 0.18, 0.36],
];

function colourAt(map, share) {
  const c = polynomials[map];
  const t = Math.min(1, Math.max(0, share));
  return [0, 1, 2].map((k) => {
    let v = 0;
    for (let power = c.length; power-- > 0;) v = v * t + c[power][k];
    return Math.min(1, Math.max(0, v));
  });
}

// Further kinds repeat them.
const kindColour = (kind) => kindColours[kind % kindColours.length];

function css(rgb) {
  return "rgb(" + rgb.map((v) => Math.round(255 * v)).join(",") + ")";
}

// kinds: colours of kinds in place of numbers.
function colourTable(map, kinds) {
  const bytes = new Uint8Array(256 * 4);
  for (let k = 0; k < 256; ++k) {
    const rgb = kinds ? kindColour(k) : colourAt(map, k / 255);
    bytes.set([...rgb.map((v) => Math.round(255 * v)), 255], 4 * k);
  }
  return bytes;
}

function gradient(map) {
  const stops = [];
  for (let k = 0; k <= 12; ++k) stops.push(css(colourAt(map, k / 12)));
  return "linear-gradient(to right," + stops.join(",") + ")";
}

// What is known to whole steps: no digit finer than that, seven at most.
function digitsTo(v, step) {
  if (v === null || !isFinite(v) || !(step > 0)) return digits(v);
  const unit = 10 ** Math.ceil(Math.log10(step) - 1e-9);
  const whole = Math.round(v / unit);
  if (whole === 0) return "0";
  const known = Math.min(7, 1 + Math.floor(Math.log10(Math.abs(whole))));
  const shown = whole * unit;
  const size = Math.abs(shown);
  return size < 1e-3 || size >= 1e7
    ? shown
        .toExponential(known - 1)
        .replace("e+", "e")
        .replace(/\.0+e/, "e")
    : String(Number(shown.toPrecision(known)));
}

// A time of these, told from those of the frames beside it; as time_text in render_run.cpp.
function timeText(times, time) {
  const apart = times.length > 1 ? (times[times.length - 1] - times[0]) / (times.length - 1) : 0;
  const telling = apart > 0 && Math.abs(time) > apart ? 1 + Math.ceil(Math.log10(Math.abs(time) / apart)) : 0;
  return telling > 4 ? String(Number(time.toPrecision(Math.min(12, telling)))) : digits(time);
}

// Start, middle and end of a legend: one text where all values are the same, no half counts. An end beyond which values
// lie by more than the digits shown says so. extremes: of the values.
function rangeTicks(range, whole, extremes) {
  const [low, high] = range;
  const [least, most] = extremes || range;
  const below = least < low && digits(least) !== digits(low);
  const above = most > high && digits(most) !== digits(high);
  if (low === high) return [`${below || above ? "most" : "all"} ${digits(low)}`];
  const middle = (low + high) / 2;
  const ends = [(below ? "<= " : "") + digits(low), (above ? ">= " : "") + digits(high)];
  return whole && !Number.isInteger(middle) ? ends : [ends[0], digits(middle), ends[1]];
}

// Four digits, no trailing zeros.
function digits(v) {
  if (v === null || !isFinite(v)) return "-";
  const size = Math.abs(v);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return v.toExponential(2).replace("e+", "e").replace(/\.?0+e/, "e");
  return String(Number(v.toPrecision(4)));
}
