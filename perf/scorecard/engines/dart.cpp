/// @file dart.cpp  DART, double precision: LCP of all contacts by Dantzig or sweeps, DART's own collision detector,
/// which knows boxes and spheres only. Options: solver=dantzig|pgs. Planes are boxes 200 m wide.
#include <dart/dart.hpp>

#include "driver.h"

namespace {

using namespace dart;

Eigen::Vector3d vector(const scorecard::Vec& v) { return {v[0], v[1], v[2]}; }

class DartEngine final : public scorecard::Engine {
 public:
  DartEngine(const scorecard::Scene& scene, const scorecard::Options& options) : scene_(scene) {
    world_->setGravity(vector(scene.gravity));
    world_->setTimeStep(options.dt);
    auto solver = std::make_unique<constraint::BoxedLcpConstraintSolver>();
    if (options.word("solver", "dantzig") == "pgs")
      solver->setBoxedLcpSolver(std::make_shared<constraint::PgsBoxedLcpSolver>());
    solver->setCollisionDetector(collision::DARTCollisionDetector::create());
    solver->getCollisionOption().maxNumContacts = 1000;
    world_->setConstraintSolver(std::move(solver));
    for (const auto& plane : scene.planes) add_plane(plane);
    for (const auto& body : scene.bodies) add_body(body);
  }

  void step() override { world_->step(); }

  scorecard::Pose pose(std::size_t body) override {
    const dynamics::BodyNode* node = bodies_[body];
    const Eigen::Vector3d x = node->getWorldTransform().translation();
    const Eigen::Quaterniond q(node->getWorldTransform().linear());
    const Eigen::Vector3d v = node->getCOMLinearVelocity(), w = node->getAngularVelocity();
    return {x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
  }

 private:
  const scorecard::Scene scene_;
  simulation::WorldPtr world_ = simulation::World::create();
  std::vector<dynamics::BodyNode*> bodies_;
  int names_ = 0;

  void give_shape(dynamics::BodyNode* node, const dynamics::ShapePtr& shape) {
    auto* made = node->createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(shape);
    made->getDynamicsAspect()->setFrictionCoeff(scene_.friction);                   // a pair takes the smaller one
    made->getDynamicsAspect()->setRestitutionCoeff(std::sqrt(scene_.restitution));  // and the product of these
  }

  void add_plane(const scorecard::Plane& plane) {
    auto skeleton = dynamics::Skeleton::create("plane" + std::to_string(++names_));
    auto [joint, node] = skeleton->createJointAndBodyNodePair<dynamics::WeldJoint>();
    give_shape(node, std::make_shared<dynamics::BoxShape>(Eigen::Vector3d(200, 200, 2)));
    Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
    at.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), vector(plane.normal)).toRotationMatrix();
    at.translation() = vector(plane.normal) * (plane.offset - 1);
    joint->setTransformFromParentBodyNode(at);
    skeleton->setMobile(false);
    world_->addSkeleton(skeleton);
  }

  void add_body(const scorecard::Body& body) {
    if (body.kind == "hull") scorecard::fail("DART's own detector knows no hulls");
    auto skeleton = dynamics::Skeleton::create("body" + std::to_string(++names_));
    auto [joint, node] = skeleton->createJointAndBodyNodePair<dynamics::FreeJoint>();
    if (body.kind == "sphere") {
      give_shape(node, std::make_shared<dynamics::SphereShape>(body.radius));
    } else {
      give_shape(node, std::make_shared<dynamics::BoxShape>(2 * vector(body.half)));
    }
    node->setInertia(dynamics::Inertia(body.mass, Eigen::Vector3d::Zero(), vector(body.inertia).asDiagonal()));
    Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
    at.linear() = Eigen::Quaterniond(body.turn[0], body.turn[1], body.turn[2], body.turn[3]).toRotationMatrix();
    at.translation() = vector(body.position);
    joint->setTransform(at);
    Eigen::Vector6d velocities;  // in axes of the body: no body that spins is turned
    velocities << vector(body.spin), vector(body.velocity);
    joint->setVelocities(velocities);
    world_->addSkeleton(skeleton);
    bodies_.push_back(node);
  }
};

}  // namespace

int main(int argc, char** argv) {
  return scorecard::run(
      argc, argv, [](const auto& scene, const auto& options) { return std::make_unique<DartEngine>(scene, options); });
}
