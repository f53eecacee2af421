/// @file bullet.cpp  Bullet, double precision. Options: solver=si|nncg|dantzig, iterations=N (10), sat=1 (hulls by
/// separating axes and clipping), margin=M of hulls [m] (0.001), threshold=D (distance below which contacts act).
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>

#include "driver.h"

namespace {

btVector3 vector(const scorecard::Vec& v) { return {v[0], v[1], v[2]}; }

class BulletEngine final : public scorecard::Engine {
 public:
  BulletEngine(const scorecard::Scene& scene, const scorecard::Options& options) : dt_(options.dt) {
    make_solver(options.word("solver", "si"));
    world_ = std::make_unique<btDiscreteDynamicsWorld>(&dispatcher_, &broad_phase_, solver_.get(), &configuration_);
    world_->setGravity(vector(scene.gravity));
    btContactSolverInfo& info = world_->getSolverInfo();
    info.m_numIterations = static_cast<int>(options.number("iterations", info.m_numIterations));
    // the MLCP solver wants each island in a problem of its own
    if (options.word("solver", "si") == "dantzig") info.m_minimumSolverBatchSize = 1;
    world_->getDispatchInfo().m_enableSatConvex = options.has("sat");
    for (const auto& plane : scene.planes) {
      add(new btStaticPlaneShape(vector(plane.normal), plane.offset), nullptr, scene, options);
    }
    first_free_ = bodies_.size();
    for (const auto& body : scene.bodies) add(shape_of(body, options), &body, scene, options);
  }

  ~BulletEngine() override {
    for (auto& body : bodies_) world_->removeRigidBody(body.get());
  }

  void step() override { world_->stepSimulation(dt_, 0); }  // 0: one step of exactly dt

  scorecard::Pose pose(std::size_t body) override {
    const btRigidBody& b = *bodies_[first_free_ + body];
    const btVector3 x = b.getWorldTransform().getOrigin(), v = b.getLinearVelocity(), w = b.getAngularVelocity();
    const btQuaternion q = b.getWorldTransform().getRotation();
    return {x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
  }

 private:
  double dt_;
  std::size_t first_free_ = 0;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btDantzigSolver dantzig_;
  std::unique_ptr<btConstraintSolver> solver_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;

  void make_solver(const std::string& name) {
    if (name == "nncg") {
      solver_ = std::make_unique<btNNCGConstraintSolver>();
    } else if (name == "dantzig") {
      solver_ = std::make_unique<btMLCPSolver>(&dantzig_);
    } else {
      solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
    }
  }

  static btCollisionShape* shape_of(const scorecard::Body& body, const scorecard::Options& options) {
    if (body.kind == "sphere") return new btSphereShape(body.radius);
    if (body.kind == "box") return new btBoxShape(vector(body.half));
    auto* hull = new btConvexHullShape();
    for (const auto& v : body.vertices) hull->addPoint(vector(v), false);
    hull->recalcLocalAabb();
    // Bullet enlarges hulls by their margin, 0.04 m as shipped: 1 mm here, and its overlaps are still those of bare
    // hulls
    hull->setMargin(options.number("margin", 1e-3));
    // without this and m_enableSatConvex hull against hull finds one point a step
    if (options.has("sat")) hull->initializePolyhedralFeatures();
    return hull;
  }

  void add(btCollisionShape* shape, const scorecard::Body* body, const scorecard::Scene& scene,
           const scorecard::Options& options) {
    shapes_.emplace_back(shape);
    const btVector3 inertia = body ? vector(body->inertia) : btVector3(0, 0, 0);
    btRigidBody::btRigidBodyConstructionInfo info(body ? body->mass : 0.0, nullptr, shape, inertia);
    info.m_startWorldTransform.setIdentity();
    if (body) {
      const auto& q = body->turn;
      info.m_startWorldTransform = btTransform(btQuaternion(q[1], q[2], q[3], q[0]), vector(body->position));
    }
    info.m_friction = std::sqrt(scene.friction);  // a pair takes the product
    info.m_restitution = std::sqrt(scene.restitution);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    // contacts are seen 20 mm ahead and then brake the body, so that restitution is lost below steps of 1/60 s;
    // a threshold of 0 lets it bounce, too high
    if (options.has("threshold")) bodies_.back()->setContactProcessingThreshold(options.number("threshold", 0.0));
    if (body) {
      bodies_.back()->setLinearVelocity(vector(body->velocity));
      bodies_.back()->setAngularVelocity(vector(body->spin));
    }
    world_->addRigidBody(bodies_.back().get());
  }
};

}  // namespace

int main(int argc, char** argv) {
  return scorecard::run(argc, argv, [](const auto& scene, const auto& options) {
    return std::make_unique<BulletEngine>(scene, options);
  });
}
