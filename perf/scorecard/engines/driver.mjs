// driver.mjs  Common part of the drivers in node: the same scene, arguments and answer as driver.h, which explains
// them. V8 compiles the engine for seconds at each start, so one start makes all three measurements, and not one a
// turn. Warm-up: whole runs for 0.3 s, at most ten: JavaScript is compiled on the way, for Rapier after five.
import fs from 'fs';

class Words {
  constructor(text) {
    this.words = text.split(/\s+/).filter(Boolean);
    this.at = 0;
  }
  more() { return this.at < this.words.length; }
  word() { return this.words[this.at++]; }
  number() { return Number(this.word()); }
  numbers(count) { return Array.from({ length: count }, () => this.number()); }
}

function readBody(words, kind) {
  const body = { kind, vertices: [], faces: [] };
  if (kind === 'sphere') {
    body.radius = words.number();
  } else if (kind === 'box') {
    body.half = words.numbers(3);
  } else {
    const [vertices, faces] = words.numbers(2);
    for (let k = 0; k < vertices; ++k) body.vertices.push(words.numbers(3));
    for (let k = 0; k < faces; ++k) body.faces.push(words.numbers(3));
  }
  body.mass = words.number();
  for (const [name, count] of [['inertia', 3], ['position', 3], ['turn', 4], ['velocity', 3], ['spin', 3]]) {
    body[name] = words.numbers(count);
  }
  return body;
}

export function readScene(name) {
  const words = new Words(fs.readFileSync(name, 'utf8'));
  const scene = { planes: [], bodies: [] };
  while (words.more()) {
    const word = words.word();
    if (word === 'gravity') scene.gravity = words.numbers(3);
    else if (word === 'friction') scene.friction = words.number();
    else if (word === 'restitution') scene.restitution = words.number();
    else if (word === 'wall_friction') scene.wallFriction = words.number();
    else if (word === 'modulus') scene.modulus = words.numbers(2);
    else if (word === 'plane') scene.planes.push({ normal: words.numbers(3), offset: words.number() });
    else scene.bodies.push(readBody(words, word));
  }
  return scene;
}

export function readArguments() {
  const [scene, duration, dt, every, poses, ...rest] = process.argv.slice(2);
  const options = { dt: Number(dt) };
  for (const word of rest) {
    const [key, value] = word.split('=');
    options[key] = value === undefined ? '1' : value;
  }
  return { scene, duration: Number(duration), every: Number(every), poses, options, rest };
}

function processorSeconds() {
  const used = process.cpuUsage();
  return 1e-6 * (used.user + used.system);
}

/// make(scene, options) gives { step(), pose(body), free() }; pose as in driver.h.
export function run(make) {
  const { scene: name, duration, every: interval, poses, options } = readArguments();
  const scene = readScene(name);
  const steps = Math.round(duration / options.dt), every = Math.max(1, Math.round(interval / options.dt));
  const lines = [];
  const once = (writes) => {
    const world = make(scene, options);
    const write = (k) => {
      lines.push(`t ${k * options.dt}`);
      scene.bodies.forEach((_, b) => lines.push(world.pose(b).join(' ')));
    };
    if (writes) write(0);
    let seconds = 0;
    for (let k = 0; k < steps;) {
      const until = writes ? Math.min(steps, (Math.floor(k / every) + 1) * every) : steps;
      const begin = processorSeconds();
      for (; k < until; ++k) world.step();
      seconds += processorSeconds() - begin;
      if (writes) write(k);
    }
    world.free();
    return seconds;
  };
  // V8 compiles during the first runs, for seconds: none of them counts, however long
  let last = once(poses !== '-'), before = Infinity;
  if (poses !== '-') fs.writeFileSync(poses, lines.join('\n') + '\n');
  for (let k = 0, spent = 0; k < 2 || (k < 20 && (spent < 0.3 || last < 0.7 * before)); ++k) {
    before = last;
    last = once(false);
    spent += last;
  }
  const measured = last > 2 ? [last] : [];  // a long run counts itself
  const runs = Math.max(1, Math.ceil(0.05 / Math.max(last, 1e-4)));
  while (last <= 2 && measured.length < 3) {
    let sum = 0;
    for (let r = 0; r < runs; ++r) sum += once(false);
    measured.push(sum / runs);
  }
  const perSecond = measured.map((seconds) => seconds / duration);
  console.log(JSON.stringify({ cpu_s_per_s: perSecond, steps, dt: options.dt }));
  process.exit(0);
}
