// rapier.mjs  Rapier (npm, WebAssembly, single precision). Options: iterations=N (4), prediction=M [m] (0.002),
// frequency=F of the contact spring [Hz] (30). allowedLinearError changes nothing in these problems; the frequency,
// which can be written and not read, decides how far bodies sink.
import { run } from './driver.mjs';
import { open } from './packages.mjs';

const RAPIER = (await open('@dimforge/rapier3d-compat/dist/rapier.mjs')).default;
const warn = console.warn;
console.warn = () => {};  // it warns of how it is started
await RAPIER.init();
console.warn = warn;
const vector = ([x, y, z]) => ({ x, y, z });

function colliderOf(body) {
  if (body.kind === 'sphere') return RAPIER.ColliderDesc.ball(body.radius);
  if (body.kind === 'box') return RAPIER.ColliderDesc.cuboid(...body.half);
  return RAPIER.ColliderDesc.convexHull(new Float32Array(body.vertices.flat()));
}

run((scene, options) => {
  const world = new RAPIER.World(vector(scene.gravity));
  const parameters = world.integrationParameters;
  world.timestep = options.dt;
  if (options.iterations) world.numSolverIterations = Number(options.iterations);
  if (options.prediction) parameters.normalizedPredictionDistance = Number(options.prediction);
  if (options.frequency) parameters.contact_natural_frequency = Number(options.frequency);
  // a pair takes the mean
  const surface = (collider) => collider.setFriction(scene.friction).setRestitution(scene.restitution);
  for (const plane of scene.planes) {
    const at = plane.normal.map((c) => c * plane.offset);
    const body = world.createRigidBody(RAPIER.RigidBodyDesc.fixed().setTranslation(...at));
    world.createCollider(surface(new RAPIER.ColliderDesc(new RAPIER.HalfSpace(vector(plane.normal)))), body);
  }
  const bodies = scene.bodies.map((b) => {
    const [w, x, y, z] = b.turn;
    const description = RAPIER.RigidBodyDesc.dynamic().setTranslation(...b.position).setRotation({ w, x, y, z });
    description.setLinvel(...b.velocity).setAngvel(vector(b.spin)).setCanSleep(false);
    const body = world.createRigidBody(description);
    world.createCollider(surface(colliderOf(b)).setMass(b.mass), body);
    return body;
  });
  return {
    step: () => world.step(),
    pose: (k) => {
      const x = bodies[k].worldCom(), q = bodies[k].rotation(), v = bodies[k].linvel(), w = bodies[k].angvel();
      return [x.x, x.y, x.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z];
    },
    free: () => world.free(),
  };
});
