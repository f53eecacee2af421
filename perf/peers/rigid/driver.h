/// @file driver.h  Runs a file of convex bodies in another engine: perf/peers/rigid.py writes the file, builds a driver
/// for each engine that is installed, and judges the poses. Nothing of Epafi is in here.
/// Usage: DRIVER bodies.txt dt steps sample poses.txt [option=value]...
/// The file, one body after the other: `b VERTICES TRIANGLES MASS IXX IYY IZZ PX PY PZ QW QX QY QZ`, mass 0: fixed;
/// then `v X Y Z` about the centre of mass in principal axes [m] and `f A B C`, outward. A pose every `sample` steps:
/// `t TIME`, then per free body position, orientation (w x y z), velocity and angular velocity (world axes).
/// Prints the medians of processor time per step over the last half and the last 15 % of steps [ms].
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace peers {

using Vec = std::array<double, 3>;

struct Body {
  std::vector<Vec> vertices;
  std::vector<std::array<int, 3>> triangles;
  double mass = 0.0;                       ///< [kg], 0: fixed
  Vec inertia{}, position{};               ///< principal moments [kg m^2], centre of mass [m]
  std::array<double, 4> turn{1, 0, 0, 0};  ///< w x y z
  bool fixed() const { return mass == 0.0; }
  /// Half lengths of a box with faces along its axes; all zero where the body is none.
  Vec half_lengths() const {
    Vec half{};
    for (int k = 0; k < 3; ++k)
      for (const Vec& v : vertices) half[k] = std::max(half[k], v[k]);
    for (const Vec& v : vertices)
      for (int k = 0; k < 3; ++k)
        if (vertices.size() != 8 || std::abs(std::abs(v[k]) - half[k]) > 1e-12) return {};
    return half;
  }
};

struct Motion {
  double numbers[13];  ///< position, orientation, velocity, angular velocity
};

struct Settings {
  double dt = 0.0, friction = 0.5;
  std::map<std::string, std::string> options;
  int number(const char* name, int otherwise) const {
    const auto at = options.find(name);
    return at == options.end() ? otherwise : std::atoi(at->second.c_str());
  }
  std::string word(const char* name, const char* otherwise) const {
    const auto at = options.find(name);
    return at == options.end() ? otherwise : at->second;
  }
};

/// One world of an engine.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual void build(const std::vector<Body>& bodies, const Settings& settings) = 0;
  virtual void step() = 0;
  virtual Motion motion(std::size_t body) = 0;
};

inline std::vector<Body> read_bodies(const char* name) {
  std::ifstream in(name);
  std::vector<Body> bodies;
  for (std::string word; in >> word;) {
    if (word != "b") std::exit((std::fprintf(stderr, "%s: expected a body, found %s\n", name, word.c_str()), 2));
    Body b;
    std::size_t vertices = 0, triangles = 0;
    in >> vertices >> triangles >> b.mass;
    for (double& x : b.inertia) in >> x;
    for (double& x : b.position) in >> x;
    for (double& x : b.turn) in >> x;
    b.vertices.resize(vertices);
    b.triangles.resize(triangles);
    for (Vec& v : b.vertices) in >> word >> v[0] >> v[1] >> v[2];
    for (auto& t : b.triangles) in >> word >> t[0] >> t[1] >> t[2];
    bodies.push_back(std::move(b));
  }
  return bodies;
}

inline double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double median_of_last(std::vector<double> seconds, double share) {
  seconds.erase(seconds.begin(),
                seconds.begin() + static_cast<long>((1 - share) * static_cast<double>(seconds.size())));
  std::nth_element(seconds.begin(), seconds.begin() + static_cast<long>(seconds.size() / 2), seconds.end());
  return seconds[seconds.size() / 2];
}

inline int run(int argc, char** argv, Engine& engine) {
  if (argc < 6) {
    std::fprintf(stderr, "usage: %s bodies.txt dt steps sample poses.txt [option=value]...\n", argv[0]);
    return 2;
  }
  const std::vector<Body> bodies = read_bodies(argv[1]);
  Settings settings;
  settings.dt = std::atof(argv[2]);
  const long steps = std::atol(argv[3]), sample = std::atol(argv[4]);
  for (int k = 6; k < argc; ++k) {
    const std::string text = argv[k];
    settings.options[text.substr(0, text.find('='))] = text.substr(text.find('=') + 1);
  }
  engine.build(bodies, settings);
  std::FILE* out = std::fopen(argv[5], "w");
  std::vector<double> seconds;
  for (long k = 1; k <= steps; ++k) {
    const double begin = processor_seconds();
    engine.step();
    seconds.push_back(processor_seconds() - begin);
    if (k % sample != 0 && k != steps) continue;
    std::fprintf(out, "t %.9g\n", static_cast<double>(k) * settings.dt);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies[b].fixed()) continue;
      const Motion m = engine.motion(b);
      for (int i = 0; i < 13; ++i) std::fprintf(out, "%.12g%c", m.numbers[i], i < 12 ? ' ' : '\n');
    }
  }
  std::fclose(out);
  std::printf("ms %.6g %.6g\n", 1e3 * median_of_last(seconds, 0.5), 1e3 * median_of_last(seconds, 0.15));
  return 0;
}

}  // namespace peers
