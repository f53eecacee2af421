/// @file driver.h  Common part of the native drivers of perf/scorecard: reads a scene, runs it, clocks the steps.
/// Usage: DRIVER SCENE DURATION DT EVERY POSES [KEY=VALUE ...]
/// SCENE (written by scene.py): `gravity X Y Z`, `friction MU`, `restitution E`, `modulus E NU`, `plane NX NY NZ D`
/// (solid below n.x = D) and free bodies `sphere R`, `box HX HY HZ` or `hull NV NF x y z ... a b c ...`, each followed
/// by mass, three moments of inertia, position, orientation w x y z, velocity, angular velocity. EVERY: seconds between
/// poses, 0: every step. POSES: a file that gets `t TIME` and 13 numbers per body, or - for none.
/// One run that is not counted (it writes the poses), then whole runs until the steps took 0.2 s of the process' clock
/// or steps and building 1 s; building and start-up stay outside the time. A first run of more than 0.5 s counts
/// itself, without its writing. Prints one line of JSON.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace scorecard {

using Vec = std::array<double, 3>;

struct Plane {
  Vec normal{};
  double offset = 0.0;
};

struct Body {
  std::string kind;
  double radius = 0.0, mass = 0.0;
  Vec half{}, inertia{}, position{}, velocity{}, spin{};
  std::array<double, 4> turn{1, 0, 0, 0};  ///< w x y z
  std::vector<Vec> vertices;
  std::vector<std::array<int, 3>> faces;  ///< triangles, outward
};

struct Scene {
  Vec gravity{};
  double friction = 0.0, restitution = 0.0;
  double wall_friction = -1.0;      ///< of upright planes, below 0: the same
  std::array<double, 2> modulus{};  ///< Young's [Pa] and Poisson's ratio: for smooth contact alone
  std::vector<Plane> planes;
  std::size_t tubes = 0;  ///< hollow walls, of granular problems
  std::vector<Body> bodies;
};

struct Options {
  double dt = 0.0;
  std::map<std::string, std::string> all;
  bool has(const std::string& key) const { return all.count(key) > 0; }
  std::string word(const std::string& key, const std::string& otherwise) const {
    const auto at = all.find(key);
    return at == all.end() ? otherwise : at->second;
  }
  double number(const std::string& key, double otherwise) const {
    return has(key) ? std::atof(all.at(key).c_str()) : otherwise;
  }
};

/// Position, orientation w x y z, velocity and angular velocity in axes of the world.
using Pose = std::array<double, 13>;

class Engine {
 public:
  virtual ~Engine() = default;
  virtual void step() = 0;
  virtual Pose pose(std::size_t body) = 0;
};

using Make = std::function<std::unique_ptr<Engine>(const Scene&, const Options&)>;

[[noreturn]] inline void fail(const std::string& text) {
  std::fprintf(stderr, "%s\n", text.c_str());
  std::exit(2);
}

template <class Numbers>
void read(std::istream& in, Numbers& numbers) {
  for (auto& number : numbers) in >> number;
}

inline Body read_body(std::istream& in, const std::string& kind) {
  Body b;
  b.kind = kind;
  if (kind == "sphere") {
    in >> b.radius;
  } else if (kind == "box") {
    read(in, b.half);
  } else {
    std::size_t vertices = 0, faces = 0;
    in >> vertices >> faces;
    b.vertices.resize(vertices);
    b.faces.resize(faces);
    for (auto& v : b.vertices) read(in, v);
    for (auto& f : b.faces) read(in, f);
  }
  in >> b.mass;
  read(in, b.inertia);
  read(in, b.position);
  read(in, b.turn);
  read(in, b.velocity);
  read(in, b.spin);
  return b;
}

inline Scene read_scene(const char* name) {
  std::ifstream in(name);
  Scene scene;
  for (std::string word; in >> word;) {
    if (word == "gravity") {
      read(in, scene.gravity);
    } else if (word == "friction") {
      in >> scene.friction;
    } else if (word == "restitution") {
      in >> scene.restitution;
    } else if (word == "wall_friction") {
      in >> scene.wall_friction;
    } else if (word == "modulus") {
      read(in, scene.modulus);
    } else if (word == "plane") {
      Plane p;
      read(in, p.normal);
      in >> p.offset;
      scene.planes.push_back(p);
    } else if (word == "material" || word == "pair" || word == "made_of" || word == "tube") {
      scene.tubes += word == "tube";  // granular codes read the rest (grains.py), Epafi has it in its own file
      std::getline(in, word);
    } else if (word == "sphere" || word == "box" || word == "hull") {
      scene.bodies.push_back(read_body(in, word));
    } else {
      fail(std::string(name) + ": what is " + word + "?");
    }
  }
  return scene;
}

inline Options read_options(int argc, char** argv) {
  if (argc < 6) fail(std::string("usage: ") + argv[0] + " SCENE DURATION DT EVERY POSES [KEY=VALUE ...]");
  Options options;
  options.dt = std::atof(argv[3]);
  for (int k = 6; k < argc; ++k) {
    const std::string text = argv[k];
    const auto equal = text.find('=');
    options.all[text.substr(0, equal)] = equal == std::string::npos ? "1" : text.substr(equal + 1);
  }
  return options;
}

inline double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Steps the engine and returns the seconds between the poses that are written.
inline double run_once(Engine& engine, std::size_t bodies, long steps, double dt, long every, std::FILE* poses) {
  const auto write = [&](long k) {
    std::fprintf(poses, "t %.12g\n", static_cast<double>(k) * dt);
    for (std::size_t b = 0; b < bodies; ++b) {
      const Pose p = engine.pose(b);
      for (std::size_t i = 0; i < 13; ++i) std::fprintf(poses, "%.14g%c", p[i], i < 12 ? ' ' : '\n');
    }
  };
  if (poses) write(0);
  double seconds = 0.0;
  for (long k = 0; k < steps;) {
    const long until = poses ? std::min(steps, (k / every + 1) * every) : steps;
    const double begin = processor_seconds();
    for (; k < until; ++k) engine.step();
    seconds += processor_seconds() - begin;
    if (poses) write(k);
  }
  return seconds;
}

inline int run(int argc, char** argv, const Make& make) {
  const Options options = read_options(argc, argv);
  const Scene scene = read_scene(argv[1]);
  const double duration = std::atof(argv[2]), interval = std::atof(argv[4]);
  const long steps = std::lround(duration / options.dt);
  const long every = std::max(1L, std::lround(interval / options.dt));
  const std::string name = argv[5];
  std::FILE* poses = name == "-" ? nullptr : std::fopen(name.c_str(), "w");
  auto first = make(scene, options);
  const double once = run_once(*first, scene.bodies.size(), steps, options.dt, every, poses);
  if (poses) std::fclose(poses);
  first.reset();
  const double begin = processor_seconds();
  double sum = once > 0.5 ? once : 0.0;
  long runs = once > 0.5 ? 1 : 0;
  while (runs == 0 || (once <= 0.5 && sum < 0.2 && processor_seconds() - begin < 1.0)) {
    auto engine = make(scene, options);
    sum += run_once(*engine, scene.bodies.size(), steps, options.dt, every, nullptr);
    ++runs;
  }
  const double seconds = sum / static_cast<double>(runs) / duration;
  std::printf("{\"cpu_s_per_s\": %.6g, \"steps\": %ld, \"dt\": %.17g}\n", seconds, steps, options.dt);
  return 0;
}

}  // namespace scorecard
