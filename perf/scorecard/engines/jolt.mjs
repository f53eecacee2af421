// jolt.mjs  Jolt (npm, WebAssembly, single precision, one thread). Options: velocity=N (10) and position=N (2)
// iterations, slop=M (0.02), speculative=M (0.02), radius=M convex radius (0.05), threshold=V (1): lengths in m,
// least speed of restitution in m/s. Those lengths are meant for games in metres and are what decides most of its
// errors here.
import { run } from './driver.mjs';
import { open } from './packages.mjs';

const J = await (await open('jolt-physics/dist/jolt-physics.wasm-compat.js')).default();
const FIXED = 0, MOVING = 1;
const vector = (v) => new J.Vec3(...v);

function newWorld() {
  const settings = new J.JoltSettings();
  settings.mMaxWorkerThreads = 0;
  const pairs = new J.ObjectLayerPairFilterTable(2);
  pairs.EnableCollision(FIXED, MOVING);
  pairs.EnableCollision(MOVING, MOVING);
  const broad = new J.BroadPhaseLayerInterfaceTable(2, 2);
  broad.MapObjectToBroadPhaseLayer(FIXED, new J.BroadPhaseLayer(0));
  broad.MapObjectToBroadPhaseLayer(MOVING, new J.BroadPhaseLayer(1));
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = broad;
  settings.mObjectVsBroadPhaseLayerFilter = new J.ObjectVsBroadPhaseLayerFilterTable(broad, 2, pairs, 2);
  return new J.JoltInterface(settings);
}

function configure(system, options) {
  const settings = system.GetPhysicsSettings();
  const names = { velocity: 'mNumVelocitySteps', position: 'mNumPositionSteps', slop: 'mPenetrationSlop',
    speculative: 'mSpeculativeContactDistance', threshold: 'mMinVelocityForRestitution' };
  for (const [option, name] of Object.entries(names)) {
    if (options[option] !== undefined) settings[name] = Number(options[option]);
  }
  settings.mAllowSleeping = false;
  system.SetPhysicsSettings(settings);
}

function made(settings) {
  const result = settings.Create();
  if (result.HasError()) throw new Error(result.GetError().c_str());
  return result.Get();
}

function shapeOf(body, radius) {
  if (body.kind === 'sphere') return made(new J.SphereShapeSettings(body.radius));
  if (body.kind === 'box')
    return made(new J.BoxShapeSettings(vector(body.half), Math.min(radius, 0.5 * Math.min(...body.half))));
  const hull = new J.ConvexHullShapeSettings();
  for (const v of body.vertices) hull.mPoints.push_back(vector(v));
  hull.mMaxConvexRadius = radius;
  return made(hull);
}

run((scene, options) => {
  const jolt = newWorld();
  const system = jolt.GetPhysicsSystem(), bodies = system.GetBodyInterface();
  configure(system, options);
  system.SetGravity(vector(scene.gravity));
  const radius = options.radius === undefined ? 0.05 : Number(options.radius);
  const add = (shape, position, turn, motion, layer, adjust) => {
    const settings = new J.BodyCreationSettings(
      shape,
      new J.RVec3(...position),
      new J.Quat(turn[1], turn[2], turn[3], turn[0]),
      motion,
      layer
    );
    settings.mFriction = scene.friction;  // a pair takes the root of the product
    settings.mRestitution = scene.restitution;  // and the larger one
    adjust(settings);
    const body = bodies.CreateBody(settings);
    bodies.AddBody(body.GetID(), layer === MOVING ? J.EActivation_Activate : J.EActivation_DontActivate);
    return body;
  };
  for (const plane of scene.planes) {
    // a plane must be static; its half extent of 1000 m is left as shipped
    const shape = made(new J.PlaneShapeSettings(new J.Plane(vector(plane.normal), -plane.offset)));
    add(shape, [0, 0, 0], [1, 0, 0, 0], J.EMotionType_Static, FIXED, () => {});
  }
  const free = scene.bodies.map((b) =>
    add(shapeOf(b, radius), b.position, b.turn, J.EMotionType_Dynamic, MOVING, (settings) => {
      settings.mLinearDamping = 0;
      settings.mAngularDamping = 0;
      settings.mAllowSleeping = false;
      settings.mMaxAngularVelocity = 1e4;  // as shipped spins are cut at 47 rad/s
      settings.mApplyGyroscopicForce = true;
      settings.mLinearVelocity = vector(b.velocity);
      settings.mAngularVelocity = vector(b.spin);
      settings.mOverrideMassProperties = J.EOverrideMassProperties_CalculateInertia;
      settings.mMassPropertiesOverride.mMass = b.mass;
    })
  );
  const list = (v) => [v.GetX(), v.GetY(), v.GetZ()];
  return {
    step: () => jolt.Step(options.dt, 1),
    // each vector is read before the next is asked for: they share memory
    pose: (k) => {
      const position = list(free[k].GetCenterOfMassPosition());
      const q = free[k].GetRotation();
      const turn = [q.GetW(), q.GetX(), q.GetY(), q.GetZ()];
      const velocity = list(free[k].GetLinearVelocity());
      return [...position, ...turn, ...velocity, ...list(free[k].GetAngularVelocity())];
    },
    free: () => J.destroy(jolt),
  };
});
