// Cells of the overlap volume: exact volumes, and forces that are the gradient of the potential they claim.
#include "detection/narrow/polyhedra/overlap_cells.h"

#include "detection/narrow/pairs/half_space_pairs.h"
#include "detection/narrow/polyhedra/polyhedra.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"

using namespace epafi;

namespace {

ContactSet cells_of(const ConvexHull& a, const Pose& pa, const ConvexHull& b, const Pose& pb) {
  ContactSet set;
  set.with_curvature = set.with_area = true;
  ContactSink sink(set);
  sink.begin(0, 1);
  collide(a, b, {pa, pb, 0.0, true, nullptr, true}, sink);
  sink.end();
  return set;
}

double potential(const ContactSet& set) {
  double sum = 0.0;
  for (std::size_t i = 0; i < set.size(); ++i) sum += 0.5 * set.area[i] * set.gap[i] * set.gap[i];
  return sum;
}

/// Force and moment about B's centre on B, unit stiffness per area.
std::pair<Vec3, Vec3> load_on_b(const ContactSet& set, const Vec3& centre) {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Vec3 f = -set.gap[i] * set.area[i] * set.normal[i];
    force += f;
    moment += (set.arm[i] - centre).cross(f);
  }
  return {force, moment};
}

/// Load on B about A's centre from cells that are cut out one by one, by all planes there are.
std::pair<Vec3, Vec3> load_by_cutting(const PolyhedronPair& pair) {
  std::vector<Plane> of_a, of_b;
  for (std::size_t f = 0; f < pair.a.face_normals.size(); ++f)
    of_a.push_back({pair.a.face_normals[f], pair.a.face_offsets[f]});
  for (std::size_t f = 0; f < pair.b.face_normals.size(); ++f) {
    const Vec3 n = pair.rotation * pair.b.face_normals[f];
    of_b.push_back({n, pair.b.face_offsets[f] + n.dot(pair.offset)});
  }
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  const auto add = [&](const std::vector<Plane>& field, double side) {
    for (const Plane& own : field) {
      ClippedSolid solid;
      solid.assign(pair.b, pair.rotation, pair.offset);
      bool left = true;
      for (const Plane& p : of_a) left = left && solid.clip(p);
      for (const Plane& p : field)
        if (&p != &own) left = left && solid.clip({p.normal - own.normal, p.offset - own.offset});
      const Volume v = left ? solid.volume() : Volume{};
      if (!(v.volume > 0.0)) continue;
      const Vec3 f = 0.5 * side * v.volume * own.normal;
      force += f;
      moment += v.centroid().cross(f);
    }
  };
  add(of_a, 1.0);
  add(of_b, -1.0);
  return {force, moment};
}

Volume volume_of(ClippedSolid& solid, const ConvexHull& hull, std::initializer_list<Plane> planes) {
  solid.assign(hull.view(), Mat3::Identity(), Vec3::Zero());
  for (const Plane& p : planes)
    if (!solid.clip(p)) return {};
  return solid.volume();
}

}  // namespace

TEST_CASE("a cube cut by planes keeps its exact volume and centroid", "[detection][volume]") {
  const Box cube(Vec3(0.5, 0.5, 0.5));
  ClippedSolid solid;
  CHECK(volume_of(solid, cube.hull, {}).volume == Approx(1.0).epsilon(1e-15));
  const Volume half = volume_of(solid, cube.hull, {{Vec3::UnitX(), 0.0}});
  CHECK(half.volume == Approx(0.5).epsilon(1e-15));
  CHECK((half.centroid() - Vec3(-0.25, 0, 0)).norm() < 1e-15);
  // the corner beyond x + y + z = 1: a right tetrahedron of legs 1/2, volume 1/48, centroid 1/8 from the three faces
  const Vec3 diagonal = Vec3(1, 1, 1).normalized();
  const Volume corner = volume_of(solid, cube.hull, {{-diagonal, -1.0 / std::sqrt(3.0)}});
  CHECK(corner.volume == Approx(1.0 / 48.0).epsilon(1e-14));
  CHECK((corner.centroid() - Vec3(0.375, 0.375, 0.375)).norm() < 1e-14);
  // cut through two opposite edges, then through the new ones again: planes that pass exactly through vertices
  const Volume wedge =
      volume_of(solid, cube.hull, {{Vec3(1, 1, 0).normalized(), 0.0}, {Vec3(1, -1, 0).normalized(), 0.0}});
  CHECK(wedge.volume == Approx(0.25).epsilon(1e-14));
  CHECK(volume_of(solid, cube.hull, {{Vec3::UnitZ(), -0.5}}).volume == 0.0);  // only a face is left
}

TEST_CASE("both bodies' cells fill the overlap of two cubes", "[detection][volume]") {
  const Box cube(Vec3(0.5, 0.5, 0.5));
  for (const Vec3& offset : {Vec3(0.9, 0, 0), Vec3(0.8, 0.3, -0.2), Vec3(0.5, 0.5, 0.5), Vec3(1e-7 - 1, 0, 0)}) {
    const ContactSet set = cells_of(cube.hull, {}, cube.hull, {offset, Quat(1, 0, 0, 0)});
    double volume_a = 0.0, volume_b = 0.0;
    for (std::size_t i = 0; i < set.size(); ++i)
      (set.feature[i] >> 44 == 4 ? volume_a : volume_b) += -2.0 * set.gap[i] * set.area[i];
    const Vec3 overlap = Vec3(1, 1, 1) - offset.cwiseAbs();
    INFO(offset.transpose());
    CHECK(volume_a == Approx(overlap.prod()).epsilon(1e-8));  // the thinnest overlap is 1e-7: rounding is 1e-9 of it
    CHECK(volume_b == Approx(overlap.prod()).epsilon(1e-8));
  }
  CHECK(cells_of(cube.hull, {}, cube.hull, {Vec3(1, 0, 0), Quat(1, 0, 0, 0)}).size() ==
        0);                                                    // faces coincide, no volume
  CHECK(cells_of(cube.hull, {}, cube.hull, {}).size() == 12);  // one in the other: six pyramids each
}

TEST_CASE("a flat slab is one cell per body: its thickness, and half its face each", "[detection][volume]") {
  const Box cube(Vec3(0.5, 0.5, 0.5));
  const ContactSet set = cells_of(cube.hull, {}, cube.hull, {Vec3(0, 0, 0.999), Quat(1, 0, 0, 0)});
  // the other planes are nearest within a rim of 1e-3 at most
  double most = 0.0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (set.normal[i].z() < 0.9) continue;
    CHECK(-set.gap[i] == Approx(1e-3).epsilon(5e-3));
    CHECK(set.area[i] == Approx(0.5).epsilon(5e-3));
    most += set.area[i];
  }
  CHECK(most == Approx(1.0).epsilon(5e-3));
}

TEST_CASE("the load of the cells is the gradient of their potential, for all six motions", "[detection][volume]") {
  Random random{7, 0};
  double worst = 0.0;
  int overlapping = 0;
  for (int k = 0; k < 200; ++k) {
    const ConvexHull a = support::random_hull(random, 10 + k % 8),
                     b = support::random_hull(random, 8 + k % 9, {1, 0.7, 0.5});
    const Quat turn = testing::random_turn(random);
    const Vec3 place = (1.0 + 0.3 * random.uniform(0, 1)) * testing::random_direction(random);
    const ContactSet set = cells_of(a, {}, b, {place, turn});
    if (set.size() == 0) continue;
    ++overlapping;
    const auto [force, moment] = load_on_b(set, place);
    const double h = 1e-6;  // second derivatives are of order 1: the difference errs by 1e-10 rounding, 1e-12 curvature
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 e = Vec3::Unit(axis);
      const auto moved = [&](double s) { return potential(cells_of(a, {}, b, {place + s * e, turn})); };
      const auto turned = [&](double s) {
        return potential(cells_of(a, {}, b, {place, Quat(Eigen::AngleAxisd(s, e)) * turn}));
      };
      worst = std::max(worst, std::abs((moved(-h) - moved(h)) / (2 * h) - force[axis]));
      worst = std::max(worst, std::abs((turned(-h) - turned(h)) / (2 * h) - moment[axis]));
    }
  }
  CHECK(overlapping > 100);
  CHECK(worst < 1e-8);
}

TEST_CASE("cells are the same whichever body is A, and from far away", "[detection][volume]") {
  Random random{11, 0};
  for (int k = 0; k < 50; ++k) {
    const ConvexHull a = support::random_hull(random, 12), b = support::random_hull(random, 14);
    const Pose pa{Vec3(1, 2, 3), testing::random_turn(random)},
        pb{pa.position + 1.5 * testing::random_direction(random), testing::random_turn(random)};
    const ContactSet ab = cells_of(a, pa, b, pb), ba = cells_of(b, pb, a, pa);
    CHECK(potential(ab) == Approx(potential(ba)).epsilon(1e-9).margin(1e-18));
    CHECK((load_on_b(ab, pb.position - pa.position).first + load_on_b(ba, pa.position - pb.position).first).norm() <
          1e-12);
  }
}

TEST_CASE("cells are what the overlap cut by all planes of both bodies gives, however thin it is",
          "[detection][volume]") {
  Random random{19, 0};
  for (const double depth : {0.3, 1e-2, 1e-4, 1e-6}) {
    for (int k = 0; k < 150; ++k) {
      const ConvexHull a = support::random_hull(random, 10 + k % 8),
                       b = support::random_hull(random, 8 + k % 9, {1, 0.7, 0.5});
      Pose pose{2.0 * testing::random_direction(random), testing::random_turn(random)};
      for (int step = 0; step < 4; ++step) {  // pushed together along the axis, which may turn on the way
        const SeparatingAxis axis = polyhedron_distance(PolyhedronPair(a.view(), b.view(), {}, pose)).axis;
        pose.position -= (axis.gap + depth) * axis.normal;
      }
      const PolyhedronPair pair(a.view(), b.view(), {}, pose);
      const ContactSet set = cells_of(a, {}, b, pose);
      const auto [force, moment] = load_on_b(set, Vec3::Zero());
      const auto [reference, reference_moment] = load_by_cutting(pair);
      // rounding of places is 1e-16, of the volume that over its thickness
      const double error = (force - reference).norm() + (moment - reference_moment).norm();
      INFO(depth << " " << k);
      CHECK(error <= 1e-14 / depth * reference.norm() + 1e-14 * depth * depth * depth);
    }
  }
}

TEST_CASE("below a plane one cell holds the whole volume, and its load is the gradient too", "[detection][volume]") {
  Random random{13, 0};
  const HalfSpace floor{Vec3::UnitZ()};
  double worst = 0.0;
  for (int k = 0; k < 50; ++k) {
    const ConvexHull a = support::random_hull(random, 12);
    const Quat turn = testing::random_turn(random);
    const auto at = [&](const Vec3& x, const Quat& q) {
      ContactSet set;
      set.with_curvature = set.with_area = true;
      ContactSink sink(set);
      sink.begin(0, 1);
      collide_closed(a, floor, {{x, q}, {}, 0.0, true, nullptr, true}, sink);
      sink.end();
      return set;
    };
    const Vec3 x(0.3, -0.2, random.uniform(0.3, 0.8));
    const ContactSet set = at(x, turn);
    REQUIRE(set.size() <= 1);
    if (set.size() == 0) continue;
    const Vec3 force = set.gap[0] * set.area[0] * set.normal[0], moment = set.arm[0].cross(force);
    const double h = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 e = Vec3::Unit(axis);
      const auto turned = [&](double s) { return potential(at(x, Quat(Eigen::AngleAxisd(s, e)) * turn)); };
      worst = std::max(
          worst, std::abs((potential(at(x - h * e, turn)) - potential(at(x + h * e, turn))) / (2 * h) - force[axis]));
      worst = std::max(worst, std::abs((turned(-h) - turned(h)) / (2 * h) - moment[axis]));
    }
  }
  CHECK(worst < 1e-8);
}
