/// @file mesh.cpp  Bodies on a triangulated floor: ns per pair of body and mesh, and the largest deviation from the
/// plane. perf_mesh: spheres, capsules and boxes on a floor of 2 x 40 x 40 triangles, one thread, median of 9.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "detection/narrow/narrow_phase.h"
#include "engine/threads/parallel.h"
#include "engine/units/random.h"

using namespace epafi;

namespace {

TriangleSurface floor_of(std::uint32_t n) {
  TriangleSurface s;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) s.vertices.push_back({-1.0 + 2.0 * i / n, -1.0 + 2.0 * j / n, 0.0});
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t k = j * (n + 1) + i;
      s.triangles.push_back({k, k + 1, k + n + 2});
      s.triangles.push_back({k, k + n + 2, k + n + 1});
    }
  return s;
}

void measure(const char* name, ShapeStore& shapes, ShapeRef floor, ShapeRef shape, double height) {
  World world(Columns{.rotation = true});
  world.add({.shape = floor.packed});
  PairList list;
  list.margin = 0.01;
  list.generation = 1;
  Random random(1, 0);
  constexpr Slot bodies = 1000;
  for (Slot k = 1; k <= bodies; ++k) {
    const Vec3 place(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), height);
    world.add({.position = place, .mass = 1.0, .inertia = Vec3(1, 1, 1), .shape = shape.packed});
    list.pairs.push_back({0, k});
  }
  BatchNarrowPhase narrow(shapes, 0.0, true);
  ContactSet contacts;
  narrow.collide(world, list, contacts);  // finds the candidate triangles
  std::vector<double> times;
  for (int repeat = 0; repeat < 9; ++repeat) {
    const auto begin = std::chrono::steady_clock::now();
    narrow.collide(world, list, contacts);
    times.push_back(std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count() /
                    bodies);
  }
  std::sort(times.begin(), times.end());
  double error = 0.0;
  for (std::size_t k = 0; k < contacts.size(); ++k)
    error = std::max({error, (contacts.normal[k] - Vec3::UnitZ()).norm(), std::abs(contacts.gap[k] + 1e-4)});
  std::printf("%-8s %8.0f ns per pair (%.0f-%.0f)  %5zu contacts  deviation from the plane %.1e\n", name, times[4],
              times.front(), times.back(), contacts.size(), error);
}

/// Candidates of rods that lie askew on a floor that does so too: boxes along the axes against oriented ones. Error:
/// candidates of the one that a triangle-by-triangle search needs and the other lacks.
void measure_trees() {
  const Quat askew(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  TriangleSurface surface = floor_of(100);
  for (Vec3& v : surface.vertices) v = askew * v;
  const TriangleMesh along = TriangleMesh::from_surface(surface);
  TriangleMesh oriented = TriangleMesh::from_surface(surface);
  oriented.orient_boxes();
  const Box rod(Vec3(0.3, 0.01, 0.01));
  Random random(2, 0);
  std::vector<Pose> poses;
  for (int k = 0; k < 1000; ++k)
    poses.push_back({askew * Vec3(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 0.005),
                     askew * Quat(Eigen::AngleAxisd(random.uniform(0.0, 3.0), Vec3::UnitZ()))});
  for (const TriangleMesh* mesh : {&along, &std::as_const(oriented)}) {
    std::vector<std::uint32_t> found;
    std::size_t candidates = 0, missing = 0;
    double best = infinity;
    for (int repeat = 0; repeat < 9; ++repeat) {
      candidates = 0;
      const auto begin = std::chrono::steady_clock::now();
      for (const Pose& pose : poses) {
        found.clear();
        mesh->find_near(rod, pose, 1e-3, found);
        candidates += found.size();
      }
      best = std::min(best, std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count());
    }
    for (const Pose& pose : poses) {
      found.clear();
      mesh->find_near(rod, pose, 1e-3, found);
      for (std::uint32_t t = 0; t < mesh->triangles.size(); ++t) {
        const auto c = mesh->corners(t);
        const Vec3 middle = pose.to_local((c[0] + c[1] + c[2]) / 3.0);
        const bool inside = (middle.cwiseAbs().array() <= rod.half.array()).all();
        missing += inside && !std::binary_search(found.begin(), found.end(), t);
      }
    }
    std::printf("rod, %-8s %8.0f ns per search  %6.1f candidates  %zu missing\n", mesh == &along ? "aabb" : "obb",
                best / 1000.0, static_cast<double>(candidates) / 1000.0, missing);
  }
}

}  // namespace

int main() {
  set_thread_count(1);
  ShapeStore shapes;
  const ShapeRef floor = shapes.add(TriangleMesh::from_surface(floor_of(40)));
  measure("sphere", shapes, floor, shapes.add(Sphere{0.05}), 0.0499);
  measure("capsule", shapes, floor, shapes.add(Capsule(0.05, 0.0999)), 0.09985);
  measure("cylinder", shapes, floor, shapes.add(Cylinder(0.05, 0.1)), 0.0499);
  measure("box", shapes, floor, shapes.add(Box(Vec3(0.05, 0.05, 0.05))), 0.0499);
  measure_trees();
}
