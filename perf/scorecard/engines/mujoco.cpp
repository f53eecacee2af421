/// @file mujoco.cpp  MuJoCo 2.2, double precision: soft contacts. Options: cone=pyramidal|elliptic, impratio=R,
/// noslip=N, multiccd=1, hard=1 (contact spring of two steps, impedance 0.99 to 0.999).
/// -DDESCRIBE_ONLY leaves the engine out and makes a program that prints the scene's description, for MuJoCo 3.
#include <iostream>
#include <sstream>

#include "driver.h"

namespace {

template <class Numbers>
std::string attribute(const char* name, const Numbers& numbers) {
  std::ostringstream out;
  out.precision(15);
  out << ' ' << name << "=\"";
  for (const double c : numbers) out << c << ' ';
  out << '"';
  return out.str();
}

/// Contact parameters. MuJoCo has no restitution: a contact is a spring with half a period of ten steps, damped so that
/// a free bounce returns e times the speed (negative solref: stiffness and damping themselves).
std::string contact_parameters(const scorecard::Scene& scene, const scorecard::Options& options) {
  std::ostringstream out;
  out.precision(15);
  if (scene.restitution > 0.0) {
    const double half = options.number("period", 10) * options.dt, log = std::log(scene.restitution);
    const double damping = scene.restitution < 1 ? -log / std::sqrt(M_PI * M_PI + log * log) : 0.0;
    const double stiffness = M_PI * M_PI / (half * half) / (1 - damping * damping);
    out << " solref=\"" << -stiffness << ' ' << -2 * damping * std::sqrt(stiffness)
        << "\" solimp=\"0.9999 0.9999 0.001\"";
  } else if (options.has("hard")) {
    out << " solref=\"" << 2 * options.dt << " 1\" solimp=\"0.99 0.999 0.001\"";
  }
  return out.str();
}

std::string head(const scorecard::Scene& scene, const scorecard::Options& options) {
  const std::size_t n = scene.bodies.size();
  std::ostringstream out;
  out.precision(15);
  out << "<mujoco><compiler boundmass=\"0\"/>";
  if (options.has("memory")) {
    out << "<size memory=\"" << (n > 50 ? 400 : 30) << "M\"/>";  // MuJoCo 3
  } else {
    out << "<size njmax=\"" << 20 * n + 800 << "\" nconmax=\"" << 8 * n + 500 << "\" nstack=\""
        << (n > 50 ? 40000000 : 5000000) << "\"/>";
  }
  // the cone as shipped is a pyramid inside Coulomb's: up to 29 % too weak off its axes
  out << "<option timestep=\"" << options.dt << '"' << attribute("gravity", scene.gravity) << " cone=\""
      << options.word("cone", "pyramidal") << '"';
  if (options.has("impratio")) out << " impratio=\"" << options.word("impratio", "") << '"';
  if (options.has("noslip")) out << " noslip_iterations=\"" << options.word("noslip", "") << '"';
  // 2.2 finds one point between two hulls unless it is asked for more; MuJoCo 3 finds a face
  out << '>' << (options.has("multiccd") ? "<flag multiccd=\"enable\"/>" : "") << "</option>";
  out << "<default><geom condim=\"" << (scene.friction > 0 ? 3 : 1) << "\" friction=\"" << scene.friction << " 0 0\""
      << contact_parameters(scene, options) << "/></default>";
  return out.str();
}

std::string description(const scorecard::Scene& scene, const scorecard::Options& options) {
  std::ostringstream meshes, tree;
  for (const auto& p : scene.planes) {
    const scorecard::Vec at = {p.normal[0] * p.offset, p.normal[1] * p.offset, p.normal[2] * p.offset};
    tree << "<geom type=\"plane\" size=\"0 0 1\"" << attribute("pos", at) << attribute("zaxis", p.normal) << "/>\n";
  }
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const auto& b = scene.bodies[k];
    tree << "<body name=\"b" << k << '"' << attribute("pos", b.position) << attribute("quat", b.turn)
         << "><freejoint/>";
    // inertia as given: meshes are turned to axes of their own, bodies are not
    tree << "<inertial pos=\"0 0 0\"" << attribute("mass", std::array{b.mass}) << attribute("diaginertia", b.inertia)
         << "/>";
    if (b.kind == "sphere") {
      tree << "<geom type=\"sphere\"" << attribute("size", std::array{b.radius});
    } else if (b.kind == "box") {
      tree << "<geom type=\"box\"" << attribute("size", b.half);
    } else {
      std::vector<double> corners;
      for (const auto& v : b.vertices) corners.insert(corners.end(), v.begin(), v.end());
      meshes << "<mesh name=\"m" << k << '"' << attribute("vertex", corners) << "/>\n";
      tree << "<geom type=\"mesh\" mesh=\"m" << k << '"';
    }
    tree << "/></body>\n";
  }
  return head(scene, options) + "<asset>" + meshes.str() + "</asset><worldbody>" + tree.str() + "</worldbody></mujoco>";
}

}  // namespace

#ifndef DESCRIBE_ONLY
#include <mujoco/mujoco.h>
#include <unistd.h>

namespace {

class MujocoEngine final : public scorecard::Engine {
 public:
  MujocoEngine(const scorecard::Scene& scene, const scorecard::Options& options) {
    const std::string name = "mujoco_" + std::to_string(getpid()) + ".xml";
    std::ofstream(name) << description(scene, options);
    char error[500] = "";
    model_ = mj_loadXML(name.c_str(), nullptr, error, sizeof error);
    std::remove(name.c_str());
    if (!model_) scorecard::fail(std::string("mujoco: ") + error);
    data_ = mj_makeData(model_);
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
      const int body = mj_name2id(model_, mjOBJ_BODY, ("b" + std::to_string(k)).c_str());
      joints_.push_back(model_->body_jntadr[body]);
      mjtNum* velocity = data_->qvel + model_->jnt_dofadr[joints_[k]];
      std::copy(scene.bodies[k].velocity.begin(), scene.bodies[k].velocity.end(), velocity);
      std::copy(scene.bodies[k].spin.begin(), scene.bodies[k].spin.end(),
                velocity + 3);  // no body that spins is turned
    }
  }

  ~MujocoEngine() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  void step() override { mj_step(model_, data_); }

  scorecard::Pose pose(std::size_t body) override {
    const mjtNum* x = data_->qpos + model_->jnt_qposadr[joints_[body]];
    const mjtNum* v = data_->qvel + model_->jnt_dofadr[joints_[body]];
    mjtNum w[3];
    mju_rotVecQuat(w, v + 3, x + 3);  // qvel turns in axes of the body
    return {x[0], x[1], x[2], x[3], x[4], x[5], x[6], v[0], v[1], v[2], w[0], w[1], w[2]};
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  std::vector<int> joints_;
};

}  // namespace

int main(int argc, char** argv) {
  return scorecard::run(argc, argv, [](const auto& scene, const auto& options) {
    return std::make_unique<MujocoEngine>(scene, options);
  });
}
#else
int main(int argc, char** argv) {
  const scorecard::Options options = scorecard::read_options(argc, argv);
  std::cout << description(scorecard::read_scene(argv[1]), options);
}
#endif
