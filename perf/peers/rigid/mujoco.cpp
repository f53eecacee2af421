/// MuJoCo (Debian libmujoco-dev, double precision): soft contacts, Newton's method. Options: hard=1 (time constant of a
/// contact two steps, the stiffest that is stable), iterations=N (its default is 100).
/// g++ -O2 -std=c++17 mujoco.cpp -lmujoco
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <sstream>

#include "driver.h"

class Mujoco final : public peers::Engine {
 public:
  ~Mujoco() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  void build(const std::vector<peers::Body>& bodies, const peers::Settings& settings) override {
    const std::string name = "mujoco_" + std::to_string(getpid()) + ".xml";
    std::ofstream(name) << description(bodies, settings);
    char error[500] = "";
    model_ = mj_loadXML(name.c_str(), nullptr, error, sizeof error);
    std::remove(name.c_str());
    if (model_ == nullptr) std::exit((std::fprintf(stderr, "mujoco: %s\n", error), 2));
    data_ = mj_makeData(model_);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const int id = mj_name2id(model_, mjOBJ_BODY, ("b" + std::to_string(b)).c_str());
      joint_.push_back(bodies[b].fixed() ? -1 : model_->body_jntadr[id]);
    }
  }
  void step() override { mj_step(model_, data_); }
  peers::Motion motion(std::size_t body) override {
    const mjtNum* x = data_->qpos + model_->jnt_qposadr[joint_[body]];
    const mjtNum* v = data_->qvel + model_->jnt_dofadr[joint_[body]];
    mjtNum w[3];
    mju_rotVecQuat(w, v + 3, x + 3);  // it turns in axes of the body
    return {{x[0], x[1], x[2], x[3], x[4], x[5], x[6], v[0], v[1], v[2], w[0], w[1], w[2]}};
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  std::vector<int> joint_;

  static std::string description(const std::vector<peers::Body>& bodies, const peers::Settings& settings) {
    std::ostringstream meshes, tree, all;
    for (auto* text : {&meshes, &tree, &all}) text->precision(15);
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const peers::Body& b = bodies[k];
      const auto half = b.half_lengths();
      tree << "<body name=\"b" << k << "\" pos=\"" << list(b.position) << "\" quat=\"" << list(b.turn) << "\">";
      if (!b.fixed())
        tree << "<freejoint/><inertial pos=\"0 0 0\" mass=\"" << b.mass << "\" diaginertia=\"" << list(b.inertia)
             << "\"/>";
      if (half[0] > 0) {
        tree << "<geom type=\"box\" size=\"" << list(half) << "\"/></body>\n";
        continue;
      }
      meshes << "<mesh name=\"m" << k << "\" vertex=\"";
      for (const auto& v : b.vertices) meshes << list(v) << ' ';
      meshes << "\"/>\n";
      tree << "<geom type=\"mesh\" mesh=\"m" << k << "\"/></body>\n";
    }
    const std::size_t n = bodies.size();
    all << "<mujoco><size njmax=\"" << 40 * n + 400 << "\" nconmax=\"" << 30 * n + 500 << "\" nstack=\""
        << (n > 50 ? 600000000L : 30000000L)
        << "\"/><compiler inertiafromgeom=\"false\" boundmass=\"0\"/><option timestep=\"" << settings.dt
        << "\" gravity=\"0 0 -9.81\" solver=\"Newton\" iterations=\"" << settings.number("iterations", 100)
        << "\" jacobian=\"" << (n > 50 ? "sparse" : "dense") << "\"/><default><geom condim=\"3\" friction=\""
        << settings.friction << " 0 0\"";
    if (settings.number("hard", 0) != 0) all << " solref=\"" << 2 * settings.dt << " 1\" solimp=\"0.99 0.999 0.001\"";
    all << "/></default><asset>" << meshes.str() << "</asset><worldbody>" << tree.str() << "</worldbody></mujoco>";
    return all.str();
  }
  template <class Numbers>
  static std::string list(const Numbers& numbers) {
    std::ostringstream text;
    text.precision(15);
    for (double x : numbers) text << x << ' ';
    return text.str();
  }
};

int main(int argc, char** argv) {
  Mujoco engine;
  return peers::run(argc, argv, engine);
}
