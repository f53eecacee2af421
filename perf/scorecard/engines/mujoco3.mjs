// mujoco3.mjs  MuJoCo 3 (npm @mujoco/mujoco, WebAssembly, double precision). Options as in mujoco.cpp: the program
// mujoco3_describe, which is that driver without its engine, writes the text that is read here.
import { execFileSync } from 'child_process';
import path from 'path';
import { readArguments, run } from './driver.mjs';
import { open } from './packages.mjs';

const M = await (await open('@mujoco/mujoco/mujoco.js')).default();
const { scene, options, rest } = readArguments();
const words = [scene, '0', String(options.dt), '0', '-', 'memory=1', ...rest];
const text = execFileSync(path.join(process.cwd(), 'mujoco3_describe'), words, { maxBuffer: 1 << 28 }).toString();
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/// v in axes of the world, given in those of a body turned by [w, ...u].
function turned(v, [w, ...u]) {
  const twice = cross(u, v).map((c) => 2 * c);
  return cross(u, twice).map((c, i) => v[i] + w * twice[i] + c);
}

run((s) => {
  const model = M.MjModel.from_xml_string(text);
  const data = new M.MjData(model);
  s.bodies.forEach((b, k) => [...b.velocity, ...b.spin].forEach((c, i) => { data.qvel[6 * k + i] = c; }));
  return {
    step: () => M.mj_step(model, data),
    pose: (k) => {
      const x = Array.from(data.qpos.slice(7 * k, 7 * k + 7)), v = Array.from(data.qvel.slice(6 * k, 6 * k + 6));
      return [...x, ...v.slice(0, 3), ...turned(v.slice(3), x.slice(3))];  // qvel turns in axes of the body
    },
    free: () => {
      data.delete();
      model.delete();
    },
  };
});
