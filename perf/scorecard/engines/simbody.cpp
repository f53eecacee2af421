/// @file simbody.cpp  Simbody, double precision: compliant contact (Hertz and Hunt-Crossley for spheres, penalties at
/// the corners of a brick on a half-space), friction of Hollars, integrator with error control. DT is the interval of
/// reports; steps within it are Simbody's. Options: accuracy=A of the integrator, transition=V [m/s] below which
/// friction creeps, speed=V [m/s] of impacts that have the restitution.
#include <Simbody.h>

#include "driver.h"

namespace {

using namespace SimTK;

Vec3 vector(const scorecard::Vec& v) { return {v[0], v[1], v[2]}; }

class SimbodyEngine final : public scorecard::Engine {
 public:
  SimbodyEngine(const scorecard::Scene& scene, const scorecard::Options& options)
      : scene_(scene),
        dt_(options.dt),
        speed_(options.number("speed", 1.0)),
        weight_(forces_, matter_, vector(scene.gravity)) {
    contact_.setTransitionVelocity(options.number("transition", 0.01));
    for (const auto& plane : scene.planes) add_plane(plane);
    for (const auto& body : scene.bodies) add_body(body);
    State state = system_.realizeTopology();
    for (std::size_t k = 0; k < bodies_.size(); ++k) place(state, bodies_[k], scene.bodies[k]);
    integrator_ = std::make_unique<RungeKuttaMersonIntegrator>(system_);
    integrator_->setAccuracy(options.number("accuracy", 1e-3));
    stepper_ = std::make_unique<TimeStepper>(system_, *integrator_);
    stepper_->initialize(state);
  }

  void step() override { stepper_->stepTo(++steps_ * dt_); }

  scorecard::Pose pose(std::size_t body) override {
    const State& state = integrator_->getState();
    system_.realize(state, Stage::Velocity);
    const MobilizedBody& b = bodies_[body];
    const Vec3 x = b.getBodyOriginLocation(state), v = b.getBodyOriginVelocity(state),
               w = b.getBodyAngularVelocity(state);
    const Vec4 q = b.getBodyRotation(state).convertRotationToQuaternion().asVec4();
    return {x[0], x[1], x[2], q[0], q[1], q[2], q[3], v[0], v[1], v[2], w[0], w[1], w[2]};
  }

 private:
  const scorecard::Scene scene_;
  const double dt_, speed_;
  long steps_ = 0;
  MultibodySystem system_;
  SimbodyMatterSubsystem matter_{system_};
  GeneralForceSubsystem forces_{system_};
  ContactTrackerSubsystem tracker_{system_};
  CompliantContactSubsystem contact_{system_, tracker_};
  Force::UniformGravity weight_;
  std::vector<MobilizedBody> bodies_;
  std::unique_ptr<RungeKuttaMersonIntegrator> integrator_;
  std::unique_ptr<TimeStepper> stepper_;

  ContactMaterial material() const {
    // Simbody joins two stiffnesses and two dissipations as springs in series: equal ones give half the stiffness. Its
    // restitution, 1 - c v, falls with speed: c is that of an impact at one speed
    const double stiffness = scene_.modulus[0] / (1.0 - scene_.modulus[1] * scene_.modulus[1]);
    return {stiffness, (1.0 - scene_.restitution) / speed_, scene_.friction, scene_.friction, 0.0};
  }

  void add_plane(const scorecard::Plane& plane) {
    // its half-space is solid on the side of +x
    const Rotation turn(UnitVec3(-vector(plane.normal)), XAxis);
    matter_.updGround().updBody().addContactSurface(Transform(turn, vector(plane.normal) * plane.offset),
                                                    ContactSurface(ContactGeometry::HalfSpace(), material()));
  }

  void add_body(const scorecard::Body& body) {
    if (body.kind == "hull") scorecard::fail("simbody: hulls need meshes on elastic foundations");
    const Vec3 moments = vector(body.inertia);
    Body::Rigid rigid(MassProperties(body.mass, Vec3(0), Inertia(moments[0], moments[1], moments[2])));
    if (body.kind == "sphere") {
      rigid.addContactSurface(Transform(), ContactSurface(ContactGeometry::Sphere(body.radius), material()));
    } else {
      rigid.addContactSurface(Transform(), ContactSurface(ContactGeometry::Brick(vector(body.half)), material()));
    }
    bodies_.push_back(MobilizedBody::Free(matter_.Ground(), Transform(), rigid, Transform()));
  }

  static void place(State& state, const MobilizedBody& mobile, const scorecard::Body& body) {
    const Quaternion turn(Vec4(body.turn[0], body.turn[1], body.turn[2], body.turn[3]));
    mobile.setQToFitTransform(state, Transform(Rotation(turn), vector(body.position)));
    mobile.setUToFitVelocity(state, SpatialVec(vector(body.spin), vector(body.velocity)));
  }
};

}  // namespace

int main(int argc, char** argv) {
  return scorecard::run(argc, argv, [](const auto& scene, const auto& options) {
    return std::make_unique<SimbodyEngine>(scene, options);
  });
}
