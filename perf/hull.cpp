/// @file hull.cpp  Farthest vertex of a convex hull along random directions: scan, climbing from the direction's cell,
/// climbing from the vertex of a direction 1e-3 away; and the distance of two such hulls. Error: of the height (of the
/// distance: along its normal by a scan), in units of the size.
#include <cstdio>

#include "detection/narrow/gjk/convex_answer.h"
#include "detection/shapes/placed_hull.h"
#include "engine/units/random.h"
#include "scenes/processor_time.h"

using namespace epafi;

namespace {

Vec3 direction(Random& random) {
  for (;;) {
    const Vec3 d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (d.squaredNorm() < 1.0 && d.squaredNorm() > 1e-2) return d.normalized();
  }
}

double now() { return 1e9 * thread_seconds(); }  // [ns]

double scan(const ConvexHull& h, const Vec3& d) {
  double height = -infinity;
  for (const Vec3& v : h.vertices) height = std::max(height, d.dot(v));
  return height;
}

template <class F>
double time_of(const std::vector<Vec3>& directions, std::vector<double>& heights, const F& f) {
  const double begin = now();
  for (std::size_t k = 0; k < directions.size(); ++k) heights[k] = f(directions[k]);
  return (now() - begin) / static_cast<double>(directions.size());
}

bool measure(std::size_t n) {
  Random random(n, 0);
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < n; ++k) points.push_back(direction(random).cwiseProduct(Vec3(1, 0.7, 0.4)));
  const ConvexHull h = place_hull(points).hull;
  const PolyhedronView view = h.view();
  std::vector<Vec3> directions, near;
  for (int k = 0; k < 4000; ++k) {
    directions.push_back(direction(random));
    near.push_back((k == 0 ? directions[0] : Vec3(near.back() + 1e-3 * direction(random))).normalized());
  }
  std::vector<double> exact(directions.size()), found = exact, followed = exact, exact_near = exact;
  const double by_scan = time_of(directions, exact, [&](const Vec3& d) { return scan(h, d); });
  time_of(near, exact_near, [&](const Vec3& d) { return scan(h, d); });
  const double by_climb = time_of(directions, found, [&](const Vec3& d) { return d.dot(h.support(d)); });
  std::uint32_t last = 0;
  const double by_warm = time_of(
      near, followed, [&](const Vec3& d) { return d.dot(h.vertices[last = ConvexHull::climb(view, d, last)]); });
  double error = 0.0;
  for (std::size_t k = 0; k < exact.size(); ++k)
    error = std::max({error, exact[k] - found[k], exact_near[k] - followed[k]});
  double distance_error = 0.0, distance_time = 0.0;
  constexpr int pairs = 50;
  for (int k = 0; k < pairs; ++k) {
    const Pose pose{2.1 * direction(random), Quat(Eigen::AngleAxisd(random.uniform(0, 3), direction(random)))};
    const double begin = now();
    const ConvexAnswer d = ask(ConvexMethod::automatic, view, view, {}, pose);
    distance_time += now() - begin;
    const double along =
        d.normal.dot(pose.position) - scan(h, pose.orientation.conjugate() * Vec3(-d.normal)) - scan(h, d.normal);
    distance_error = std::max(distance_error, std::abs(along - d.distance));
  }
  std::printf(
      "%6zu vertices: scan %7.0f ns  climb %5.0f ns  climb from near %5.0f ns  height error %.1e  distance %8.0f ns"
      "  error %.1e\n",
      h.vertices.size(), by_scan, by_climb, by_warm, error, distance_time / pairs, distance_error);
  return error < 1e-15 && distance_error < 1e-12;
}

}  // namespace

int main() {
  bool sound = true;
  for (const std::size_t n : {16u, 64u, 256u, 1000u, 3000u, 10000u}) sound = measure(n) && sound;
  return sound ? 0 : 1;
}
