/// @file epafi.cpp  Epafi through its library. The scene is SCENE.toml beside SCENE.scene; options are keys of the
/// scene (contact.nonsmooth.solver=newton); DT 0 leaves the time step to Epafi. No measures, no files: the steps alone.
#include <epafi/epafi.h>

#include "driver.h"

namespace {

class EpafiEngine final : public scorecard::Engine {
 public:
  EpafiEngine(std::unique_ptr<epafi::Assembly> assembly, std::size_t walls)
      : assembly_(std::move(assembly)), walls_(walls) {}

  void step() override {
    if (const auto failure = assembly_->simulation->advance()) scorecard::fail("epafi: " + failure->text);
  }

  scorecard::Pose pose(std::size_t body) override {
    const auto& world = assembly_->simulation->world;
    const auto slot = world.slot_of(static_cast<epafi::BodyId>(walls_ + body));  // walls are the first bodies
    const auto& q = world.pose(slot).orientation;  // of the body as drawn, not of its principal axes
    const epafi::Vec3 x = world.position[slot], v = world.velocity[slot];
    const epafi::Vec3 w = world.rotates() ? epafi::Vec3(world.angular_velocity[slot]) : epafi::Vec3::Zero();
    return {x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
  }

 private:
  std::unique_ptr<epafi::Assembly> assembly_;
  std::size_t walls_;
};

}  // namespace

int main(int argc, char** argv) {
  scorecard::read_options(argc, argv);
  std::string scene = argv[1];
  scene.replace(scene.rfind('.'), std::string::npos, ".toml");
  std::vector<std::string> keys = {"run.duration=" + std::string(argv[2])};
  if (std::atof(argv[3]) > 0.0) keys.push_back("run.time_step=" + std::string(argv[3]));
  keys.insert(keys.end(), argv + 6, argv + argc);
  try {
    char chosen[40] = "";
    std::snprintf(chosen, sizeof chosen, "%.17g", epafi::load(scene, keys)->time_step.value);
    argv[3] = chosen;
    return scorecard::run(argc, argv, [&](const scorecard::Scene& s, const scorecard::Options&) {
      return std::make_unique<EpafiEngine>(epafi::load(scene, keys), s.planes.size() + s.tubes);
    });
  } catch (const epafi::SceneError& error) {
    scorecard::fail(error.what());
  }
}
