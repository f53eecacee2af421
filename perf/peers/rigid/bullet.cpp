/// Bullet (Debian libbullet-dev, the double precision libraries). Options: iterations=N (its default is 10).
/// g++ -O2 -std=c++17 -DBT_USE_DOUBLE_PRECISION -I/usr/include/bullet bullet.cpp
///   -lBulletDynamics-float64 -lBulletCollision-float64 -lLinearMath-float64
#include <btBulletDynamicsCommon.h>

#include <memory>

#include "driver.h"

class Bullet final : public peers::Engine {
 public:
  void build(const std::vector<peers::Body>& bodies, const peers::Settings& settings) override {
    dt_ = settings.dt;
    world_.setGravity(btVector3(0, 0, -9.81));
    world_.getSolverInfo().m_numIterations = settings.number("iterations", world_.getSolverInfo().m_numIterations);
    for (const auto& b : bodies) add(b, settings.friction);
  }
  void step() override { world_.stepSimulation(dt_, 0); }  // no sub-steps: one of exactly dt
  peers::Motion motion(std::size_t body) override {
    const btRigidBody& b = *bodies_[body];
    const btVector3 x = b.getWorldTransform().getOrigin(), v = b.getLinearVelocity(), w = b.getAngularVelocity();
    const btQuaternion q = b.getWorldTransform().getRotation();
    return {{x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z()}};
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_;
  btSequentialImpulseConstraintSolver solver_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_, &solver_, &configuration_};
  double dt_ = 0.0;

  void add(const peers::Body& b, double friction) {
    const auto half = b.half_lengths();
    if (half[0] > 0) {
      shapes_.push_back(std::make_unique<btBoxShape>(btVector3(half[0], half[1], half[2])));
    } else {
      auto hull = std::make_unique<btConvexHullShape>();
      for (const auto& v : b.vertices) hull->addPoint(btVector3(v[0], v[1], v[2]), false);
      hull->recalcLocalAabb();
      hull->setMargin(0.001);  // its default of 40 mm would enlarge bodies of 100 mm by 40 %
      shapes_.push_back(std::move(hull));
    }
    btRigidBody::btRigidBodyConstructionInfo info(b.mass, nullptr, shapes_.back().get(),
                                                  btVector3(b.inertia[0], b.inertia[1], b.inertia[2]));
    info.m_startWorldTransform = btTransform(btQuaternion(b.turn[1], b.turn[2], b.turn[3], b.turn[0]),
                                             btVector3(b.position[0], b.position[1], b.position[2]));
    info.m_friction = std::sqrt(friction);  // pairs take the product
    info.m_restitution = 0.0;
    info.m_linearDamping = info.m_angularDamping = 0.0;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(bodies_.back().get());
  }
};

int main(int argc, char** argv) {
  Bullet engine;
  return peers::run(argc, argv, engine);
}
