// Case B09: degenerate placings of boxes over gaps of both signs, aspect ratios and size ratios. The exact answer
// follows from how the pair is built; the direction is checked by pushing the bodies apart along it.
#include "detection/narrow/gjk/convex_answer.h"
#include "detection/narrow/gjk/gjk.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using testing::upright;

namespace {

struct Worst {
  double error = 0.0, pushed = 0.0, swapped = 0.0, moved = 0.0;
  int iterations = 0;
};

/// All checks of one pair whose signed distance is `exact` [m]; size: bounding radius of the smaller [m].
void judge(const ConvexHull& a, const Pose& pa, const ConvexHull& b, const Pose& pb, double exact, Worst& worst) {
  const double size = std::min(a.radius, b.radius),
               large = std::max(a.radius, b.radius) + (pb.position - pa.position).norm();
  const double scale =
      size + 1e-6 * large;  // what 1e-10 refers to where the bodies differ by more than 1e4: 1e-16 of the larger
  const auto d = ask(ConvexMethod::automatic, a.view(), b.view(), pa, pb);
  worst.error = std::max(worst.error, std::abs(d.distance - exact) / scale);
  if (d.distance < 0.0) {  // pushed out by the depth it touches
    const Pose out{pb.position - d.distance * d.normal, pb.orientation};
    worst.pushed =
        std::max(worst.pushed, std::abs(ask(ConvexMethod::automatic, a.view(), b.view(), pa, out).distance) / scale);
  }
  worst.swapped = std::max(
      worst.swapped, std::abs(ask(ConvexMethod::automatic, b.view(), a.view(), pb, pa).distance - d.distance) / scale);
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(0.36, 0.48, 0.8)));
  const Pose ma{turn * pa.position, turn * pa.orientation}, mb{turn * pb.position, turn * pb.orientation};
  worst.moved = std::max(
      worst.moved, std::abs(ask(ConvexMethod::automatic, a.view(), b.view(), ma, mb).distance - d.distance) / scale);
  worst.iterations =
      std::max(worst.iterations, gjk(MinkowskiDifference(ConvexRef::to(a), ConvexRef::to(b), pa, pb)).iterations);
}

void check(const Worst& worst) {
  INFO("error " << worst.error << ", pushed out " << worst.pushed << ", swapped " << worst.swapped << ", moved "
                << worst.moved << " of the size, " << worst.iterations << " iterations");
  CHECK(worst.error < 1e-10);
  CHECK(worst.pushed < 1e-9);
  CHECK(worst.swapped < 1e-10);
  CHECK(worst.moved < 1e-10);
  CHECK(worst.iterations < 64);
}

/// Gaps of both signs from 1e-2 to 1e-15 of `size`, and 0.
std::vector<double> gaps(double size) {
  std::vector<double> out{0.0};
  for (int k = 2; k <= 15; ++k)
    for (const double sign : {1.0, -1.0}) out.push_back(sign * size * std::pow(10.0, -k));
  return out;
}

}  // namespace

TEST_CASE("faces in one plane that cover each other in part, at aspect ratios to 1e6 (B09)", "[detection][B09]") {
  Worst worst;
  for (double aspect = 1.0; aspect < 2e6; aspect *= 10.0) {
    const Box plate(Vec3(0.5, 0.5, 0.5 / aspect)), cube(Vec3::Constant(0.5));
    for (const double gap : gaps(1.0 / aspect)) {
      const double z = 0.5 + 0.5 / aspect + gap;
      judge(cube.hull, {}, plate.hull, {{0.3, 0.2, z}, upright}, (z - 0.5) - 0.5 / aspect, worst);
    }
  }
  check(worst);
}

TEST_CASE("faces in one plane at size ratios to 1e6 (B09)", "[detection][B09]") {
  Worst worst;
  for (double ratio = 1.0; ratio < 2e6; ratio *= 10.0) {
    const double h = 0.5 / ratio;
    const Box cube(Vec3::Constant(0.5)), small(Vec3::Constant(h));
    for (const double gap : gaps(h)) {
      const double z = 0.5 + h + gap;
      judge(cube.hull, {}, small.hull, {{0.3, 0.2, z}, upright}, (z - 0.5) - h, worst);
    }
  }
  check(worst);
}

TEST_CASE("a vertex over a vertex, along the diagonal of two cubes (B09)", "[detection][B09]") {
  Worst worst;
  const Box cube(Vec3::Constant(0.5));
  for (const double gap : gaps(1.0)) {
    const double c = 1.0 + gap;  // corner to corner: sqrt(3) gap apart, or `gap` deep along any axis
    const double apart = c - 1.0;
    judge(cube.hull, {}, cube.hull, {{c, c, c}, upright}, apart > 0.0 ? std::sqrt(3.0) * apart : apart, worst);
  }
  check(worst);
}

TEST_CASE("parallel edges over each other, and an edge over a vertex (B09)", "[detection][B09]") {
  Worst worst;
  const Box cube(Vec3::Constant(0.5));
  for (const double gap : gaps(1.0)) {
    const double c = 1.0 + gap, apart = c - 1.0;
    for (const double along : {0.0, 0.25, 0.9})  // edges along z, shifted along themselves
      judge(cube.hull, {}, cube.hull, {{c, c, along}, upright}, apart > 0.0 ? std::sqrt(2.0) * apart : apart, worst);
  }
  // B stands on a vertex of an octahedron over A's edge, A turned by 45 degrees about y: the top edge is at height
  // sqrt(1/2).
  const ConvexHull octahedron =
      ConvexHull::from_faces({{0.5, 0, 0}, {-0.5, 0, 0}, {0, 0.5, 0}, {0, -0.5, 0}, {0, 0, 0.5}, {0, 0, -0.5}},
                             {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}})
          .hull;
  const Quat turned(Eigen::AngleAxisd(std::atan(1.0), Vec3::UnitY()));
  for (const double gap : gaps(1.0)) {
    if (gap < 0.0) continue;  // deep, the way out is sideways
    judge(cube.hull, {Vec3::Zero(), turned}, octahedron, {{0, 0.1, std::sqrt(0.5) + 0.5 + gap}, upright},
          (std::sqrt(0.5) + 0.5 + gap) - 0.5 - std::sqrt(0.5), worst);
  }
  check(worst);
}
