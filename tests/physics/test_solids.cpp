// Closed surfaces as free bodies: mass properties against closed forms, sums over parts and sampling; convex parts;
// motion.
#include <unistd.h>

#include <fstream>

#include "detection/shapes/mesh_file.h"
#include "detection/shapes/rounded_shapes.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const std::string stones = std::string(EPAFI_SOURCE_DIR) + "/scenes/library/tutorials/stones/";
const std::vector<std::string> stone_files{"stone_a.obj", "stone_b.stl", "stone_c.ply"};

/// An L of three unit cubes in the plane, one high: corner at the origin, arms along x and y.
TriangleSurface angle_bracket() {
  const std::vector<std::array<double, 2>> ring{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  TriangleSurface s;
  for (double z : {0.0, 1.0})
    for (const auto& p : ring) s.vertices.emplace_back(p[0], p[1], z);
  for (std::uint32_t k = 0; k < 6; ++k) {
    const std::uint32_t next = (k + 1) % 6;
    s.triangles.push_back({k, next, next + 6});
    s.triangles.push_back({k, next + 6, k + 6});
  }
  for (const Triangle& t : std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    s.triangles.push_back({t[0], t[2], t[1]});
    s.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  return s;
}

/// Is x inside? Parity of the crossings of a ray along a direction that meets no edge.
bool is_inside(const TriangleSurface& s, const Vec3& x) {
  const Vec3 d = Vec3(0.5773, 0.6111, 0.5414).normalized();
  int crossings = 0;
  for (const Triangle& t : s.triangles) {  // Moeller and Trumbore 1997
    const Vec3 &a = s.vertices[t[0]], e = s.vertices[t[1]] - a, f = s.vertices[t[2]] - a;
    const Vec3 p = d.cross(f);
    const double det = e.dot(p);
    if (det == 0.0) continue;
    const double u = (x - a).dot(p) / det;
    const Vec3 q = (x - a).cross(e);
    const double v = d.dot(q) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && f.dot(q) / det > 0) ++crossings;
  }
  return crossings % 2 == 1;
}

bool is_inside(const SolidParts& solid, const Vec3& x) {
  for (const auto& part : solid.parts) {
    bool inside = true;
    for (std::size_t f = 0; f < part.hull.face_normals.size(); ++f)
      inside = inside && part.hull.face_normals[f].dot(x - part.centre) <= part.hull.face_offsets[f];
    if (inside) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("an angle bracket has the mass properties of its three cubes and two convex parts", "[physics][solids]") {
  const PlacedSolid l = place_solid(angle_bracket());
  CHECK(l.solid.parts.size() == 2);
  CHECK(l.solid.volume == Approx(3.0).epsilon(1e-14));
  CHECK((l.frame.centre - Vec3(5.0 / 6, 5.0 / 6, 0.5)).norm() < 1e-14);
  // three cubes: I = sum of 1/6 + d^2 about the centre; about z: 3/6 + sum of squared distances 2 (1/9 + 1/36 + 1/9 +
  // ...) = 11/6
  double about_z = 0, about_x = 0, product = 0;
  for (const Vec3& c : {Vec3(0.5, 0.5, 0.5), Vec3(1.5, 0.5, 0.5), Vec3(0.5, 1.5, 0.5)}) {
    const Vec3 d = c - Vec3(5.0 / 6, 5.0 / 6, 0.5);
    about_z += 1.0 / 6 + d.x() * d.x() + d.y() * d.y();
    about_x += 1.0 / 6 + d.y() * d.y();
    product -= d.x() * d.y();
  }
  // in the plane the principal axes are the diagonals: about_x +- product
  Vec3 moments = l.frame.moments;
  std::sort(moments.data(), moments.data() + 3);
  Vec3 expected(about_x - std::abs(product), about_x + std::abs(product), about_z);
  std::sort(expected.data(), expected.data() + 3);
  CHECK((moments - expected).norm() < 1e-13);
}

TEST_CASE("stones: parts are disjoint, fill the surface, and carry its mass properties", "[physics][solids][long]") {
  for (const auto& file : stone_files) {
    INFO(file);
    const MeshFile mesh = read_mesh_file(stones + file);
    REQUIRE(mesh.report.is_watertight());
    const PlacedSolid stone = place_solid(mesh.surface);
    const SolidParts& solid = stone.solid;
    CHECK(solid.parts.size() > 2);  // they are not convex
    double volume = 0;
    Vec3 first = Vec3::Zero();
    Mat3 inertia = Mat3::Zero();
    for (const auto& part : solid.parts) {
      const double m = part.hull.volume;
      volume += m;
      first += m * part.centre;
      inertia += part.hull.inertia +
                 m * (part.centre.squaredNorm() * Mat3::Identity() - part.centre * part.centre.transpose());
    }
    CHECK(volume == Approx(solid.volume).epsilon(1e-12));  // the parts come from exact cuts, rounded once to double
    CHECK(first.norm() < 1e-12 * volume * solid.radius);
    CHECK((inertia - solid.inertia).norm() < 1e-11 * solid.inertia.norm());
    // independent: 10 000 random points of the box around it, by parity of a ray through the surface and by the parts'
    // planes
    Random random(7, 0);
    int inside = 0, differ = 0;
    constexpr int points = 10000;
    Vec3 low = Vec3::Constant(infinity), high = -low;
    for (const Vec3& v : solid.surface.vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    for (int k = 0; k < points; ++k) {
      const Vec3 x(random.uniform(low.x(), high.x()), random.uniform(low.y(), high.y()),
                   random.uniform(low.z(), high.z()));
      const bool by_ray = is_inside(solid.surface, x);
      inside += by_ray;
      differ += by_ray != is_inside(solid, x);
    }
    CHECK(differ == 0);
    const double share = inside / double(points), box = (high - low).prod();
    // four deviations of a binomial share
    CHECK(std::abs(share * box / solid.volume - 1) < 4 * std::sqrt((1 - share) / (share * points)));
  }
}

namespace {

/// The surface of the unit cells of a lattice for which is_solid(i, j, k) holds, squares as pairs of triangles.
template <class F>
TriangleSurface cells_surface(int n, const F& is_solid) {
  TriangleSurface s;
  const auto corner = [n](const std::array<int, 3>& c) {
    return static_cast<std::uint32_t>((c[0] * (n + 1) + c[1]) * (n + 1) + c[2]);
  };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (int k = 0; k <= n; ++k) s.vertices.emplace_back(i, j, k);
  const auto solid = [&](const std::array<int, 3>& c) {
    for (const int x : c)
      if (x < 0 || x >= n) return false;
    return bool(is_solid(c[0], c[1], c[2]));
  };
  for (int cell = 0; cell < n * n * n; ++cell)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        const std::array<int, 3> c{cell / (n * n), cell / n % n, cell % n};
        auto beside = c, a = c;
        beside[axis] += 2 * side - 1;
        if (!solid(c) || solid(beside)) continue;
        a[axis] += side;
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        auto b = a, d = a;
        b[u] += 1;
        d[v] += 1;
        auto e = b;
        e[v] += 1;
        if (side == 0) std::swap(b, d);
        s.triangles.push_back({corner(a), corner(b), corner(e)});
        s.triangles.push_back({corner(a), corner(e), corner(d)});
      }
  return s;
}

}  // namespace

TEST_CASE("a bracket, a accumulator and a hollow box are cut to as few parts in single precision, turned",
          "[physics][solids]") {
  struct Kind {
    const char* name;
    std::size_t parts;
    bool (*is_solid)(int, int, int);
  };
  const std::array<Kind, 3> kinds{
      {{"bracket", 2, [](int i, int j, int) { return i < 2 || j < 2; }},
       {"accumulator", 5, [](int i, int j, int k) { return k < 2 || i % 5 == 0 || j % 5 == 0; }},
       {"hollow box", 6, [](int i, int j, int k) { return i % 5 == 0 || j % 5 == 0 || k % 5 == 0; }}}};
  Random random(29, 0);
  for (int run = 0; run < 6; ++run) {
    const Kind& kind = kinds[static_cast<std::size_t>(run) % 3];
    INFO(kind.name << ", run " << run);
    TriangleSurface s = cells_surface(6, kind.is_solid);
    const double exact = surface_mass_properties(s).mass;
    const Vec3 axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const Quat turn(Eigen::AngleAxisd(random.uniform(0, 3), axis.normalized()));
    const double away = run < 3 ? 1.0 : 100.0;
    const Vec3 shift = away * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    double largest = 0.0;
    for (Vec3& v : s.vertices) {
      v = (turn * v + shift).cast<float>().cast<double>();
      largest = std::max(largest, v.cwiseAbs().maxCoeff());
    }
    const double precision = std::ldexp(largest, -24);
    const PlacedSolid placed = place_solid(s, {}, precision);
    CHECK(placed.solid.parts.size() == kind.parts);
    CHECK(placed.solid.volume == Approx(exact).epsilon(10 * precision));
    double sum = 0;
    for (const auto& part : placed.solid.parts) {
      CHECK(part.hull.vertices.size() == 8);
      CHECK(part.hull.face_normals.size() == 6);
      sum += part.hull.volume;
    }
    CHECK(sum == Approx(exact).epsilon(10 * precision));
    int differ = 0;
    for (int k = 0; k < 200; ++k) {
      const Vec3 x(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5));
      differ += is_inside(placed.solid.surface, x) != is_inside(placed.solid, x);
    }
    CHECK(differ == 0);
  }
}

TEST_CASE("a turned body is cut to as few parts however far its corners lie off its faces", "[physics][solids]") {
  // of 1e-10 to 1e-5 m: endless cuts, or parts that were not convex
  Random random(33, 0);
  for (int run = 0; run < 40; ++run) {
    const double off = std::pow(10.0, random.uniform(-13, -5.3)), away = random.uniform(0, 3);
    INFO("run " << run << ", corners off by " << off << " m");
    TriangleSurface s = run % 2 == 0
                            ? angle_bracket()
                            : cells_surface(6, [](int i, int j, int k) { return k < 2 || i % 5 == 0 || j % 5 == 0; });
    const double exact = surface_mass_properties(s).mass;
    s = testing::moved(std::move(s), testing::random_turn(random), away * testing::random_point(random));
    for (Vec3& v : s.vertices) v += off * testing::random_point(random);
    const PlacedSolid placed = place_solid(s);
    CHECK(placed.solid.parts.size() == (run % 2 == 0 ? 2 : 5));
    double sum = 0;
    for (const auto& part : placed.solid.parts) sum += part.hull.volume;
    CHECK(sum == Approx(exact).epsilon(1e-9 + 10 * off));
  }
}

TEST_CASE("a surface that is open or crosses itself is refused with the reason", "[physics][solids]") {
  TriangleSurface open = angle_bracket();
  open.triangles.pop_back();
  CHECK_THROWS_WITH(place_solid(open), Catch::Contains("not watertight: 3 open edges: (0, 0, 1) - (1, 2, 1)") &&
                                           Catch::Contains("needs a closed surface"));
  TriangleSurface crossed = angle_bracket();
  for (std::uint32_t k : {3u, 9u})
    crossed.vertices[k] += Vec3(-2.5, 0, 0);  // the inner corner leaves through the far side
  CHECK_THROWS_WITH(place_solid(crossed), Catch::Contains("the surface crosses itself: ") &&
                                              Catch::Contains("go through others, the first at (") &&
                                              Catch::Contains("mend it in a mesh editor"));
}

namespace {

/// A ball of triangles; a random part of its corners is displaced, swapped or drawn through the far side.
TriangleSurface spoilt_ball(Random& random) {
  const auto n = static_cast<std::uint32_t>(4 + random.bits() % 12), m = n / 2 + 2;
  TriangleSurface s;
  s.vertices = {Vec3(0, 0, -1), Vec3(0, 0, 1)};
  for (std::uint32_t j = 1; j < m; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const double u = 2 * testing::pi * i / n, w = testing::pi * j / m;
      s.vertices.emplace_back(std::sin(w) * std::cos(u), std::sin(w) * std::sin(u), -std::cos(w));
    }
  const auto at = [&](std::uint32_t j, std::uint32_t i) { return 2 + (j - 1) * n + i % n; };
  for (std::uint32_t i = 0; i < n; ++i) {
    s.triangles.push_back({0, at(1, i + 1), at(1, i)});
    s.triangles.push_back({1, at(m - 1, i), at(m - 1, i + 1)});
    for (std::uint32_t j = 1; j + 1 < m; ++j) {
      s.triangles.push_back({at(j, i), at(j, i + 1), at(j + 1, i + 1)});
      s.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j + 1, i)});
    }
  }
  const auto one = [&]() -> Vec3& { return s.vertices[random.bits() % s.vertices.size()]; };
  const int kind = static_cast<int>(random.bits() % 3);
  const double amount = std::pow(10.0, random.uniform(-2, 0));
  if (kind == 0)
    for (Vec3& v : s.vertices) v += amount * testing::random_point(random);
  for (int k = 0; kind == 1 && k < 3; ++k) std::swap(one(), one());
  if (kind == 2) {
    Vec3& v = one();
    v = -random.uniform(1.2, 3.0) * v;
  }
  return testing::moved(std::move(s), testing::random_turn(random), 3.0 * testing::random_point(random));
}

}  // namespace

TEST_CASE("a random closed surface is taken whole or refused with the place", "[physics][solids]") {
  Random random(31, 0);
  int taken = 0, refused = 0;
  for (int k = 0; k < 60; ++k) {
    const TriangleSurface s = spoilt_ball(random);
    const double exact = std::abs(surface_mass_properties(s).mass);
    try {
      const PlacedSolid placed = place_solid(s);
      double sum = 0;
      for (const auto& part : placed.solid.parts) sum += part.hull.volume;
      CHECK(sum == Approx(exact).epsilon(1e-8));
      int differ = 0;
      for (int i = 0; i < 200; ++i) {
        const Vec3 x = 2.0 * testing::random_point(random);
        differ += is_inside(placed.solid.surface, x) != is_inside(placed.solid, x);
      }
      CHECK(differ == 0);
      ++taken;
    } catch (const SceneError& error) {
      CHECK_THAT(error.what(), Catch::Contains("the surface crosses itself: ") && Catch::Contains("the first at ("));
      ++refused;
    }
  }
  CHECK(taken > 3);
  CHECK(refused > 20);
}

TEST_CASE("a box from a file moves like a box, and a mesh that may move becomes a solid", "[physics][solids]") {
  // the same scene with shape = box and shape = solid: a tilted brick falls on a floor and rolls over an edge
  const std::string folder =
      std::filesystem::temp_directory_path().string() + "/epafi_solid_" + std::to_string(::getpid());
  std::filesystem::create_directory(folder);
  std::ofstream(folder + "/brick.obj")
      << "v 0 0 0\nv 400 0 0\nv 400 200 0\nv 0 200 0\nv 0 0 100\nv 400 0 100\nv 400 200 100\nv 0 200 100\n"
         "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const auto scene = [&](const std::string& shape) {
    const std::string file = folder + "/scene.toml";
    std::ofstream(file) << "run = { duration = 1.0, time_step = 1e-3 }\nworld = { gravity = [0, 0, -9.81] }\n"
                           "material.m = { density = 1000.0 }\n"
                           "contact = { method = \"nonsmooth\", restitution = 0.0, friction = 0.3, nonsmooth = { "
                           "solver = \"newton\", tolerance = 1e-10 } }\n"
                           "[[body]]\nname = \"floor\"\nshape = { half_space = { normal = [0, 0, 1] } }\nmaterial = "
                           "\"m\"\nfixed = true\n"
                           "[[body]]\nname = \"brick\"\nshape = { " +
                               shape +
                               " }\nmaterial = \"m\"\nposition = [0, 0, 0.4]\n"
                               "euler_deg = [0, 20, 0]\nvelocity = [1, 0, 0]\n";
    auto run = prepare_scene(file, {});
    run.simulation().start();
    run.advance_to(800);
    return run;
  };
  const auto box = scene("box = { size = [0.4, 0.2, 0.1] }");
  const auto solid = scene("solid = { file = \"brick.obj\", unit = \"mm\" }");
  const auto mesh = scene("mesh = { file = \"brick.obj\", unit = \"mm\" }");
  std::filesystem::remove_all(folder);
  const World &a = box.assembly->simulation->world, &b = solid.assembly->simulation->world,
              &c = mesh.assembly->simulation->world;
  // the file's mass properties come from rounded corners: 1e-16 at the start, grown by the impacts
  CHECK((a.position[1] - b.position[1]).norm() < 1e-9);
  CHECK((a.velocity[1] - b.velocity[1]).norm() < 1e-8);
  CHECK(b.position[1] == c.position[1]);
  CHECK(a.position[1].z() == Approx(0.05).margin(1e-3));
}
