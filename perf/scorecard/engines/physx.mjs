// physx.mjs  PhysX 5.6 (npm physx-js-webidl, WebAssembly, single precision). Options: solver=pgs|tgs (pgs as shipped),
// position=N (4) and velocity=N (1) iterations, threshold=V bounce threshold [m/s] (2: the last bounces vanish).
import fs from 'fs';
import { run } from './driver.mjs';
import { file, open } from './packages.mjs';

// built for browsers alone: it throws where it sees node's process, so that is hidden while it loads
const wasmBinary = fs.readFileSync(file('physx-js-webidl/physx-js-webidl.wasm'));
const load = (await open('physx-js-webidl/physx-js-webidl.mjs')).default;
const hidden = globalThis.process;
globalThis.window = globalThis;
globalThis.process = undefined;
const P = await load({ wasmBinary });
globalThis.process = hidden;
delete globalThis.window;

const foundation = P.CreateFoundation(P.PHYSICS_VERSION, new P.PxDefaultAllocator(), new P.PxDefaultErrorCallback());
const scale = new P.PxTolerancesScale();
const physics = P.CreatePhysics(P.PHYSICS_VERSION, foundation, scale);
P.InitExtensions(physics);
const dispatcher = P.DefaultCpuDispatcherCreate(0);
const vector = (v) => new P.PxVec3(...v);

function hullOf(body) {
  const points = new P.PxArray_PxVec3();  // the heap itself is not exported
  for (const v of body.vertices) points.pushBack(vector(v));
  const description = new P.PxConvexMeshDesc();
  description.flags.raise(P.PxConvexFlagEnum.eCOMPUTE_CONVEX);
  description.points.stride = 12;
  description.points.count = body.vertices.length;
  description.points.data = points.begin();
  return new P.PxConvexMeshGeometry(P.CreateConvexMesh(new P.PxCookingParams(scale), description));
}

function geometryOf(body) {
  if (body.kind === 'sphere') return new P.PxSphereGeometry(body.radius);
  if (body.kind === 'box') return new P.PxBoxGeometry(...body.half);
  return hullOf(body);
}

function newScene(scene, options) {
  const description = new P.PxSceneDesc(scale);
  description.gravity = vector(scene.gravity);
  description.cpuDispatcher = dispatcher;
  description.filterShader = P.DefaultFilterShader();
  if (options.solver === 'tgs') description.solverType = P.PxSolverTypeEnum.eTGS;
  if (options.threshold) description.bounceThresholdVelocity = Number(options.threshold);
  return physics.createScene(description);
}

/// Turns the x axis, which is a plane's outward normal, to n.
function turnTo(n) {
  const q = n[0] < -0.999999 ? [0, 0, 1, 0] : [0, -n[2], n[1], 1 + n[0]];
  const length = Math.hypot(...q);
  return new P.PxQuat(...q.map((c) => c / length));
}

function addBody(world, shapeWith, b, options) {
  const body = physics.createRigidDynamic(
    new P.PxTransform(vector(b.position), new P.PxQuat(b.turn[1], b.turn[2], b.turn[3], b.turn[0]))
  );
  body.attachShape(shapeWith(geometryOf(b)));
  body.setMass(b.mass);
  body.setMassSpaceInertiaTensor(vector(b.inertia));
  body.setLinearDamping(0);
  body.setAngularDamping(0);
  body.setMaxAngularVelocity(1e4);
  body.setSleepThreshold(0);
  body.setStabilizationThreshold(0);
  body.setSolverIterationCounts(Number(options.position || 4), Number(options.velocity || 1));
  world.addActor(body);
  body.setLinearVelocity(vector(b.velocity));
  body.setAngularVelocity(vector(b.spin));
  return body;
}

run((scene, options) => {
  const world = newScene(scene, options);
  const material = physics.createMaterial(scene.friction, scene.friction, scene.restitution);  // a pair takes the mean
  const flags = new P.PxShapeFlags(P.PxShapeFlagEnum.eSIMULATION_SHAPE);
  const shapeWith = (geometry) => {
    const shape = physics.createShape(geometry, material, true, flags);
    shape.setSimulationFilterData(new P.PxFilterData(1, 1, 0, 0));
    return shape;
  };
  const actors = scene.planes.map((plane) => {
    const at = new P.PxTransform(vector(plane.normal.map((c) => c * plane.offset)), turnTo(plane.normal));
    const actor = physics.createRigidStatic(at);
    actor.attachShape(shapeWith(new P.PxPlaneGeometry()));  // CreatePlane gives no filter data: every pair is dropped
    world.addActor(actor);
    return actor;
  });
  const bodies = scene.bodies.map((b) => addBody(world, shapeWith, b, options));
  return {
    step: () => {
      world.simulate(options.dt);
      world.fetchResults(true);
    },
    pose: (k) => {
      const { p, q } = bodies[k].getGlobalPose();
      const out = [p.x, p.y, p.z, q.w, q.x, q.y, q.z];
      const v = bodies[k].getLinearVelocity();
      out.push(v.x, v.y, v.z);
      const w = bodies[k].getAngularVelocity();
      return [...out, w.x, w.y, w.z];
    },
    free: () => {
      for (const actor of [...actors, ...bodies]) actor.release();
      world.release();
    },
  };
});
