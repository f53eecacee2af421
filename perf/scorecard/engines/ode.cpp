/// @file ode.cpp  ODE, double precision. Options: solver=quick (dWorldQuickStep, iterations=N, 20) or dantzig
/// (dWorldStep), cfm=C. Friction is the pyramid that scales with the normal force (dContactApprox1).
#include <ode/ode.h>

#include "driver.h"

namespace {

using scorecard::Vec;

Vec minus(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// ODE keeps pointers into it.
struct Hull {
  std::vector<dReal> planes, points;
  std::vector<unsigned> polygons;
};

/// Faces must be polygons: ODE clips face against face, and triangles in one plane give it phantom edges.
std::unique_ptr<Hull> hull_of(const scorecard::Body& body) {
  struct Face {
    Vec normal;
    std::vector<unsigned> corners;
  };
  std::vector<Face> faces;
  for (const auto& t : body.faces) {
    const Vec& origin = body.vertices[t[0]];
    Vec n = cross(minus(body.vertices[t[1]], origin), minus(body.vertices[t[2]], origin));
    const double length = std::sqrt(dot(n, n));
    for (double& c : n) c /= length;
    auto same = std::find_if(faces.begin(), faces.end(), [&](const Face& f) { return dot(f.normal, n) > 1 - 1e-9; });
    if (same == faces.end()) same = faces.insert(same, {n, {}});
    for (const int c : t) {
      auto& corners = same->corners;
      if (std::find(corners.begin(), corners.end(), c) == corners.end()) corners.push_back(c);
    }
  }
  auto hull = std::make_unique<Hull>();
  for (const auto& v : body.vertices) hull->points.insert(hull->points.end(), v.begin(), v.end());
  for (Face& face : faces) {
    Vec middle{};
    for (const unsigned c : face.corners)
      for (std::size_t k = 0; k < 3; ++k) middle[k] += body.vertices[c][k] / static_cast<double>(face.corners.size());
    const Vec first = minus(body.vertices[face.corners[0]], middle), second = cross(face.normal, first);
    const auto angle = [&](unsigned c) {
      const Vec d = minus(body.vertices[c], middle);
      return std::atan2(dot(second, d), dot(first, d));
    };
    std::sort(face.corners.begin(), face.corners.end(), [&](unsigned a, unsigned b) { return angle(a) < angle(b); });
    hull->planes.insert(hull->planes.end(), face.normal.begin(), face.normal.end());
    hull->planes.push_back(dot(face.normal, middle));
    hull->polygons.push_back(static_cast<unsigned>(face.corners.size()));
    hull->polygons.insert(hull->polygons.end(), face.corners.begin(), face.corners.end());
  }
  return hull;
}

class OdeEngine final : public scorecard::Engine {
 public:
  OdeEngine(const scorecard::Scene& scene, const scorecard::Options& options)
      : scene_(scene), dt_(options.dt), quick_(options.word("solver", "quick") == "quick") {
    static const bool started = dInitODE2(0) != 0 && dAllocateODEDataForThread(dAllocateMaskAll) != 0;
    if (!started) scorecard::fail("ode does not start");
    world_ = dWorldCreate();
    contacts_ = dJointGroupCreate(0);
    space_ = scene.bodies.size() > 20 ? dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ) : dSimpleSpaceCreate(nullptr);
    dWorldSetGravity(world_, scene.gravity[0], scene.gravity[1], scene.gravity[2]);
    dWorldSetQuickStepNumIterations(world_, static_cast<int>(options.number("iterations", 20)));
    // with dWorldStep faces on faces end in "LCP internal error, s <= 0" and any forces; a CFM of 1e-7 cures the stack
    if (options.has("cfm")) dWorldSetCFM(world_, options.number("cfm", 1e-10));
    // planes and hulls do not meet inside a space that sweeps and prunes: planes lie beside it and are asked one by one
    for (const auto& p : scene.planes)
      planes_.push_back(dCreatePlane(nullptr, p.normal[0], p.normal[1], p.normal[2], p.offset));
    for (const auto& body : scene.bodies) add(body);
  }

  ~OdeEngine() override {
    for (const dGeomID plane : planes_) dGeomDestroy(plane);
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }

  void step() override {
    for (const dGeomID geom : geoms_)
      for (const dGeomID plane : planes_) collide(this, plane, geom);
    dSpaceCollide(space_, this, collide);
    if (quick_) {
      dWorldQuickStep(world_, dt_);
    } else {
      dWorldStep(world_, dt_);
    }
    dJointGroupEmpty(contacts_);
  }

  scorecard::Pose pose(std::size_t body) override {
    const dBodyID b = bodies_[body];
    const dReal *x = dBodyGetPosition(b), *q = dBodyGetQuaternion(b);
    const dReal *v = dBodyGetLinearVel(b), *w = dBodyGetAngularVel(b);
    return {x[0], x[1], x[2], q[0], q[1], q[2], q[3], v[0], v[1], v[2], w[0], w[1], w[2]};
  }

 private:
  const scorecard::Scene scene_;
  double dt_;
  bool quick_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  std::vector<std::unique_ptr<Hull>> hulls_;
  std::vector<dGeomID> planes_, geoms_;
  std::vector<dBodyID> bodies_;

  dGeomID geom_of(const scorecard::Body& b) {
    if (b.kind == "sphere") return dCreateSphere(space_, b.radius);
    if (b.kind == "box") return dCreateBox(space_, 2 * b.half[0], 2 * b.half[1], 2 * b.half[2]);
    hulls_.push_back(hull_of(b));
    Hull& h = *hulls_.back();
    const auto faces = static_cast<unsigned>(h.planes.size() / 4), points = static_cast<unsigned>(h.points.size() / 3);
    return dCreateConvex(space_, h.planes.data(), faces, h.points.data(), points, h.polygons.data());
  }

  void add(const scorecard::Body& b) {
    const dBodyID body = dBodyCreate(world_);
    dMass mass;
    dMassSetParameters(&mass, b.mass, 0, 0, 0, b.inertia[0], b.inertia[1], b.inertia[2], 0, 0, 0);
    dBodySetMass(body, &mass);
    dBodySetAutoDisableFlag(body, 0);
    const dQuaternion turn = {b.turn[0], b.turn[1], b.turn[2], b.turn[3]};
    dBodySetPosition(body, b.position[0], b.position[1], b.position[2]);
    dBodySetQuaternion(body, turn);
    dBodySetLinearVel(body, b.velocity[0], b.velocity[1], b.velocity[2]);
    dBodySetAngularVel(body, b.spin[0], b.spin[1], b.spin[2]);
    geoms_.push_back(geom_of(b));
    dGeomSetBody(geoms_.back(), body);
    bodies_.push_back(body);
  }

  static void collide(void* self, dGeomID a, dGeomID b) {
    constexpr int most = 16;
    auto& engine = *static_cast<OdeEngine*>(self);
    dContact contacts[most];
    const int count = dCollide(a, b, most, &contacts[0].geom, sizeof(dContact));
    for (int k = 0; k < count; ++k) {
      dSurfaceParameters& surface = contacts[k].surface;
      surface = {};
      surface.mode = dContactApprox1 | (engine.scene_.restitution > 0 ? dContactBounce : 0);
      surface.mu = engine.scene_.friction;
      surface.bounce = engine.scene_.restitution;
      dJointAttach(dJointCreateContact(engine.world_, engine.contacts_, &contacts[k]), dGeomGetBody(a),
                   dGeomGetBody(b));
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  return scorecard::run(
      argc, argv, [](const auto& scene, const auto& options) { return std::make_unique<OdeEngine>(scene, options); });
}
