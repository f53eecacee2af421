// Curved bodies look round, flat ones keep their faces and edges; floors are solid, what holds bodies is not.
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/catch.h"
#include "viz_export/view/grounds.h"
#include "viz_export/view/refine.h"

using namespace epafi;

namespace {

Surface drawn(ShapeStore& shapes, ShapeRef shape) { return surface_of(shapes, shape, 1); }

/// Largest value of `error` over the points that refinement adds.
template <class Error>
double worst_new(const ViewMesh& mesh, const Error& error) {
  const ViewMesh fine = refined(mesh);
  REQUIRE(fine.corners.size() == 4 * mesh.corners.size());
  REQUIRE(fine.normals.size() == fine.corners.size());
  double worst = 0;
  for (std::size_t p = mesh.points.size(); p < fine.points.size(); ++p)
    worst = std::max(worst, std::abs(error(fine.points[p].cast<double>())));
  return worst;
}

/// The same of the middles of all edges.
template <class Error>
double worst_chord(const ViewMesh& mesh, const Error& error) {
  double worst = 0;
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    const std::size_t next = c % 3 == 2 ? c - 2 : c + 1;
    const Eigen::Vector3f middle = 0.5f * (mesh.points[mesh.corners[c]] + mesh.points[mesh.corners[next]]);
    worst = std::max(worst, std::abs(error(middle.cast<double>())));
  }
  return worst;
}

BodyRecord body(std::uint32_t id, const Vec3& place, bool free, const Surface* surface = nullptr) {
  BodyRecord b;
  b.id = id;
  b.mass = free ? 1 : 0;
  b.radius = 0.1;
  b.surface = surface;
  b.pose.position = place;
  return b;
}

}  // namespace

TEST_CASE("points between those of drawn round bodies come nearer to the bodies", "[viz_export][view]") {
  // The patch is exact on circles where the normals at its corners are; those are means over facets of unlike size.
  ShapeStore shapes;
  for (const double size : {1e-4, 1.0, 300.0}) {
    const Surface ball = drawn(shapes, shapes.add(Ellipsoid{Vec3::Constant(size)}));
    CHECK(ball.curved);
    const auto from_ball = [&](const Vec3& p) { return p.norm() / size - 1; };
    CHECK(worst_new(view_mesh(ball), from_ball) < 0.35 * worst_chord(view_mesh(ball), from_ball));
    CHECK(feature_edges(refined(view_mesh(ball))).empty());
    const Vec3 axes(1, 1.5, 0.6);
    const Surface egg = drawn(shapes, shapes.add(Ellipsoid{size * axes}));
    const auto from_egg = [&](const Vec3& p) { return (p / size).cwiseQuotient(axes).norm() - 1; };
    CHECK(worst_new(view_mesh(egg), from_egg) < 0.7 * worst_chord(view_mesh(egg), from_egg));
  }
}

TEST_CASE("the rim of a cylinder becomes rounder on both sides alike", "[viz_export][view]") {
  ShapeStore shapes;
  const Surface can = drawn(shapes, shapes.add(Cylinder{0.5, 0.7}));
  const ViewMesh mesh = view_mesh(can), fine = refined(mesh);
  // New points: on the rims, on the side, in the caps; nothing stands out of the solid.
  double outermost = 0, highest = 0, rim = 0;
  for (std::size_t p = mesh.points.size(); p < fine.points.size(); ++p) {
    const double r = std::hypot(fine.points[p].x(), fine.points[p].y());
    outermost = std::max(outermost, r);
    highest = std::max(highest, static_cast<double>(std::abs(fine.points[p].z())));
    const bool on_rim = r > 0.4 && std::abs(fine.points[p].z()) > 0.3499f;
    if (on_rim) rim = std::max(rim, std::abs(r / 0.5 - 1));
  }
  CHECK(outermost < 0.5 * 1.02);
  CHECK(highest < 0.35 * 1.0001);
  CHECK(rim < 2e-3);  // chords: 3.4e-2
  // a closed surface stays one: every edge has two faces, the two rims are its only features
  CHECK(feature_edges(fine).size() == 2 * feature_edges(mesh).size());
}

TEST_CASE("superquadrics are drawn without scraps at their edges, however sharp they are", "[viz_export][view]") {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> axis(0.3, 1.0);
  ShapeStore shapes;
  for (int k = 0; k < 30; ++k) {
    const Vec3 axes(axis(random), axis(random), axis(random));
    const int across = 2 + static_cast<int>(random() % 31), along = 2 + static_cast<int>(random() % 31);
    INFO(axes.transpose() << ", exponents " << across << " " << along);
    const Superquadric shape(axes, across, along);
    const Surface surface = drawn(shapes, shapes.add(shape));
    const ViewMesh mesh = view_mesh(surface), fine = refined(mesh);
    CHECK(feature_edges(mesh).empty());  // round bodies have none
    CHECK(feature_edges(fine).empty());
    for (const Vec3& p : surface.points) {  // on the surface
      const Vec3 u = p.cwiseQuotient(axes).cwiseAbs();
      const double level =
          std::pow(std::pow(u.x(), across) + std::pow(u.y(), across), static_cast<double>(along) / across) +
          std::pow(u.z(), along);
      CHECK(level == Approx(1.0).epsilon(1e-9));
    }
    // the shading is that of the surface, where a facet ends and where refinement adds a point
    double worst = 0;
    for (const ViewMesh* one : {&mesh, &fine})
      for (std::size_t c = 0; c < one->corners.size(); ++c) {
        const Vec3 u = one->points[one->corners[c]].cast<double>().cwiseQuotient(axes);
        const double ring = std::pow(std::abs(u.x()), across) + std::pow(std::abs(u.y()), across);
        const double outer = ring > 0 ? std::pow(ring, static_cast<double>(along) / across - 1.0) : 0.0;
        Vec3 exact(outer * std::copysign(std::pow(std::abs(u.x()), across - 1), u.x()),
                   outer * std::copysign(std::pow(std::abs(u.y()), across - 1), u.y()),
                   std::copysign(std::pow(std::abs(u.z()), along - 1), u.z()));
        exact = exact.cwiseQuotient(axes).normalized();
        worst = std::max(worst, std::acos(std::min(1.0, exact.dot(one->normals[c].cast<double>()))));
      }
    CHECK(worst < 0.35);  // 20 degrees
  }
}

TEST_CASE("flat faces and their edges are not changed", "[viz_export][view]") {
  ShapeStore shapes;
  const ViewMesh mesh = view_mesh(drawn(shapes, shapes.add(Box{Vec3(0.3, 0.2, 0.1)})));
  const double out =
      worst_new(mesh, [](const Vec3& p) { return p.cwiseAbs().cwiseQuotient(Vec3(0.3, 0.2, 0.1)).maxCoeff() - 1; });
  CHECK(out < 1e-6);
  CHECK(feature_edges(refined(mesh)).size() == 2 * feature_edges(mesh).size());
}

TEST_CASE("curved bodies are refined while they are few", "[viz_export][view]") {
  ShapeStore shapes;
  const Surface pill = drawn(shapes, shapes.add(Capsule{0.1, 0.2})),
                brick = drawn(shapes, shapes.add(Box{Vec3(1, 2, 3)}));
  CHECK_FALSE(brick.curved);
  const auto triangles = [&](std::size_t bodies) {
    MeshStore store(std::vector<BodyRecord>(bodies, body(0, Vec3::Zero(), true, &pill)));
    CHECK(store.all().empty());
    (void)store.of(&pill);
    (void)store.of(&brick);
    CHECK(store.all().at(1).corners.size() == 36);
    return store.all().at(0).corners.size();
  };
  CHECK(triangles(10) == 4 * triangles(5000));
}

TEST_CASE("the seam of a turned profile is no edge", "[viz_export][view]") {
  // A tube whose last points lie at the first up to rounding: rims alone are borders.
  Surface tube;
  constexpr int sides = 40;
  for (int k = 0; k <= sides; ++k)
    for (const double z : {-1.0, 1.0}) {
      const double angle = 2 * std::numbers::pi * k / sides;
      tube.points.emplace_back(std::cos(angle), std::sin(angle), z);
    }
  for (std::int32_t k = 0; k < sides; ++k) {
    tube.connectivity.insert(tube.connectivity.end(), {2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1});
    tube.offsets.push_back(4 * (k + 1));
  }
  CHECK(feature_edges(view_mesh(tube)).size() == 2 * 2 * sides);
}

TEST_CASE("a floor is solid, what stands beside or over bodies is not", "[viz_export][view]") {
  ShapeStore shapes;
  const Surface plate = drawn(shapes, shapes.add(Box{Vec3(1, 1, 0.05)})),
                wall = drawn(shapes, shapes.add(Box{Vec3(0.05, 1, 1)}));
  for (const double down : {-1.0, 1.0}) {  // z points up, and down as on a track
    const Vec3 up(0, 0, -down);
    Grounds grounds(up);
    CHECK(grounds.ids().empty());
    ViewFrame frame;
    frame.bodies = {body(0, -0.05 * up, false, &plate), body(1, 2 * up, false, &plate),
                    body(2, Vec3(1, 0, 0), false, &wall), body(3, Vec3(0, 0, 0) + 0.1 * up, true),
                    body(4, Vec3(0.3, 0, 0) + 0.4 * up, true)};
    grounds.add(frame);
    CHECK(grounds.ids() == std::vector<std::uint32_t>{0});
    CHECK(grounds.top() == Approx(0).margin(1e-12));
    frame.bodies[4].pose.position = -0.3 * up;  // it has fallen through
    grounds.add(frame);
    CHECK(grounds.ids().empty());
  }
}

TEST_CASE("one stray of many below the floor leaves the floor solid", "[viz_export][view]") {
  ShapeStore shapes;
  const Surface plate = drawn(shapes, shapes.add(Box{Vec3(1, 1, 0.05)}));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> height(0.1, 1.0);
  ViewFrame frame;
  frame.bodies.push_back(body(0, Vec3(0, 0, -0.05), false, &plate));
  for (std::uint32_t k = 1; k <= 200; ++k) frame.bodies.push_back(body(k, Vec3(0, 0, height(random)), true));
  frame.bodies.back().pose.position.z() = -50;
  Grounds grounds(Vec3::UnitZ());
  grounds.add(frame);
  CHECK(grounds.ids() == std::vector<std::uint32_t>{0});
}
