// bullet_wasm.mjs  Bullet again, compiled to WebAssembly (npm's ammojs-typed, single precision): what a simulated
// second costs more in it than in the native Bullet is what the other engines from npm may owe to WebAssembly.
// Option: iterations=N (10).
import { run } from './driver.mjs';
import { file, open } from './packages.mjs';

const folder = 'ammojs-typed/ammo/';
const B = await (await open(folder + 'ammo.wasm.js')).default({ locateFile: (name) => file(folder + name) });
const DISABLE_DEACTIVATION = 4;
const vector = (v) => new B.btVector3(...v);

function shapeOf(body) {
  if (body.kind === 'sphere') return new B.btSphereShape(body.radius);
  if (body.kind === 'box') return new B.btBoxShape(vector(body.half));
  const hull = new B.btConvexHullShape();
  for (const v of body.vertices) hull.addPoint(vector(v), true);
  hull.setMargin(1e-3);  // as the native driver
  return hull;
}

function place(body) {
  const frame = new B.btTransform();
  frame.setIdentity();
  if (body) {
    const [w, x, y, z] = body.turn;
    frame.setOrigin(vector(body.position));
    frame.setRotation(new B.btQuaternion(x, y, z, w));
  }
  return new B.btDefaultMotionState(frame);
}

run((scene, options) => {
  const configuration = new B.btDefaultCollisionConfiguration(),
    dispatcher = new B.btCollisionDispatcher(configuration);
  const world = new B.btDiscreteDynamicsWorld(
    dispatcher,
    new B.btDbvtBroadphase(),
    new B.btSequentialImpulseConstraintSolver(),
    configuration
  );
  world.setGravity(vector(scene.gravity));
  if (options.iterations) world.getSolverInfo().set_m_numIterations(Number(options.iterations));
  const add = (shape, body) => {
    const info = new B.btRigidBodyConstructionInfo(
      body ? body.mass : 0,
      place(body),
      shape,
      vector(body ? body.inertia : [0, 0, 0])
    );
    info.set_m_friction(Math.sqrt(scene.friction));  // a pair takes the product
    info.set_m_restitution(Math.sqrt(scene.restitution));
    const made = new B.btRigidBody(info);
    made.setActivationState(DISABLE_DEACTIVATION);
    if (body) {
      made.setLinearVelocity(vector(body.velocity));
      made.setAngularVelocity(vector(body.spin));
    }
    world.addRigidBody(made);
    return made;
  };
  for (const plane of scene.planes) add(new B.btStaticPlaneShape(vector(plane.normal), plane.offset), null);
  const bodies = scene.bodies.map((body) => add(shapeOf(body), body));
  const numbers = (v) => [v.x(), v.y(), v.z()];
  return {
    step: () => world.stepSimulation(options.dt, 0),
    pose: (k) => {
      const frame = bodies[k].getWorldTransform(), q = frame.getRotation();
      return [...numbers(frame.getOrigin()), q.w(), q.x(), q.y(), q.z(), ...numbers(bodies[k].getLinearVelocity()),
        ...numbers(bodies[k].getAngularVelocity())];
    },
    free: () => B.destroy(world),
  };
});
