/// ODE (Debian libode-dev, double precision), dWorldQuickStep. Options: iterations=N (its default is 20).
/// g++ -O2 -std=c++17 ode.cpp -lode
#include <ode/ode.h>

#include <deque>

#include "driver.h"

class Ode final : public peers::Engine {
 public:
  Ode() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
  }
  void build(const std::vector<peers::Body>& bodies, const peers::Settings& settings) override {
    dt_ = settings.dt;
    friction_ = settings.friction;
    world_ = dWorldCreate();
    contacts_ = dJointGroupCreate(0);
    space_ = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
    dWorldSetGravity(world_, 0, 0, -9.81);
    dWorldSetQuickStepNumIterations(world_, settings.number("iterations", 20));
    for (const auto& b : bodies) add(b);
  }
  void step() override {
    dSpaceCollide(space_, this, near);
    dWorldQuickStep(world_, dt_);
    dJointGroupEmpty(contacts_);
  }
  peers::Motion motion(std::size_t body) override {
    const dReal *x = dBodyGetPosition(bodies_[body]), *q = dBodyGetQuaternion(bodies_[body]),
                *v = dBodyGetLinearVel(bodies_[body]), *w = dBodyGetAngularVel(bodies_[body]);
    return {{x[0], x[1], x[2], q[0], q[1], q[2], q[3], v[0], v[1], v[2], w[0], w[1], w[2]}};
  }

 private:
  struct Hull {
    std::vector<dReal> planes, points;
    std::vector<unsigned> polygons;
  };
  dWorldID world_ = nullptr;
  dSpaceID space_ = nullptr;
  dJointGroupID contacts_ = nullptr;
  std::deque<Hull> hulls_;  // ODE keeps pointers into them
  std::vector<dBodyID> bodies_;
  double dt_ = 0.0, friction_ = 0.0;

  dGeomID hull(const peers::Body& b) {
    Hull& h = hulls_.emplace_back();
    for (const auto& v : b.vertices) h.points.insert(h.points.end(), v.begin(), v.end());
    for (const auto& t : b.triangles) {
      const auto &p = b.vertices[t[0]], &q = b.vertices[t[1]], &r = b.vertices[t[2]];
      double n[3], length = 0.0, distance = 0.0;
      for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i]);
        length += n[k] * n[k];
      }
      for (int k = 0; k < 3; ++k) {
        n[k] /= std::sqrt(length);
        distance += n[k] * p[k];
      }
      h.planes.insert(h.planes.end(), {n[0], n[1], n[2], distance});
      h.polygons.push_back(3);
      for (int corner : t) h.polygons.push_back(static_cast<unsigned>(corner));
    }
    return dCreateConvex(space_, h.planes.data(), static_cast<unsigned>(b.triangles.size()), h.points.data(),
                         static_cast<unsigned>(b.vertices.size()), h.polygons.data());
  }
  void add(const peers::Body& b) {
    const auto half = b.half_lengths();
    const dGeomID geom = half[0] > 0 ? dCreateBox(space_, 2 * half[0], 2 * half[1], 2 * half[2]) : hull(b);
    const dQuaternion turn = {b.turn[0], b.turn[1], b.turn[2], b.turn[3]};
    if (b.fixed()) {
      dGeomSetPosition(geom, b.position[0], b.position[1], b.position[2]);
      dGeomSetQuaternion(geom, turn);
      bodies_.push_back(nullptr);
      return;
    }
    const dBodyID body = dBodyCreate(world_);
    dMass mass;
    dMassSetParameters(&mass, b.mass, 0, 0, 0, b.inertia[0], b.inertia[1], b.inertia[2], 0, 0, 0);
    dBodySetMass(body, &mass);
    dBodySetAutoDisableFlag(body, 0);
    dBodySetPosition(body, b.position[0], b.position[1], b.position[2]);
    dBodySetQuaternion(body, turn);
    dGeomSetBody(geom, body);
    bodies_.push_back(body);
  }
  static void near(void* self, dGeomID a, dGeomID b) {
    auto& engine = *static_cast<Ode*>(self);
    if (dGeomGetBody(a) == nullptr && dGeomGetBody(b) == nullptr) return;
    dContact contact[8];
    const int count = dCollide(a, b, 8, &contact[0].geom, sizeof(dContact));
    for (int k = 0; k < count; ++k) {
      contact[k].surface = {};
      contact[k].surface.mode = dContactApprox1;
      contact[k].surface.mu = engine.friction_;
      dJointAttach(dJointCreateContact(engine.world_, engine.contacts_, &contact[k]), dGeomGetBody(a), dGeomGetBody(b));
    }
  }
};

int main(int argc, char** argv) {
  Ode engine;
  return peers::run(argc, argv, engine);
}
