// Overlaps that are written down: closed forms, cells cut out by all planes, and no trace of what a pair remembers.
#include "detection/narrow/polyhedra/overlap_forms.h"

#include "detection/narrow/pairs/half_space_pairs.h"
#include "detection/narrow/polyhedra/overlap_cells.h"
#include "detection/narrow/polyhedra/overlap_faces.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"

using namespace epafi;
using FormKind = OverlapForm::Kind;

namespace {

/// Turns the diagonal of a cube upright: the corner (-1, -1, -1) looks down.
Quat on_a_corner() { return Quat::FromTwoVectors(Vec3(-1, -1, -1), -Vec3::UnitZ()); }
/// An edge along `direction` looks along z, up or down.
Quat on_an_edge(double turn) {
  return Quat(Eigen::AngleAxisd(turn, Vec3::UnitZ())) * Quat(Eigen::AngleAxisd(std::acos(-1.0) / 4, Vec3::UnitX()));
}

ContactSet contacts(const ConvexHull& a, const Pose& pa, const ConvexHull& b, const Pose& pb, PairCache* cache) {
  ContactSet set;
  set.with_curvature = set.with_area = true;
  ContactSink sink(set);
  sink.begin(0, 1);
  collide(a, b, {pa, pb, 0.0, true, cache, true}, sink);
  sink.end();
  return set;
}

bool same_contacts(const ContactSet& x, const ContactSet& y) {
  return x.feature == y.feature && x.gap == y.gap && x.normal == y.normal && x.arm == y.arm && x.area == y.area;
}

Plane plane_of(const PolyhedronPair& pair, bool of_a, std::size_t f) {
  if (of_a) return {pair.a.face_normals[f], pair.a.face_offsets[f]};
  const Vec3 n = pair.rotation * pair.b.face_normals[f];
  return {n, pair.b.face_offsets[f] + n.dot(pair.offset)};
}

/// The overlap by all planes there are; false where there is none.
bool cut_overlap(const PolyhedronPair& pair, ClippedSolid& solid) {
  solid.assign(pair.b, pair.rotation, pair.offset);
  for (std::size_t f = 0; f < pair.a.face_normals.size(); ++f)
    if (!solid.clip(plane_of(pair, true, f))) return false;
  return true;
}

/// The same cell by all planes there are.
Volume cell_by_cutting(const PolyhedronPair& pair, const OverlapCell& cell) {
  ClippedSolid solid;
  bool left = cut_overlap(pair, solid);
  const Plane own = plane_of(pair, cell.of_a, cell.face);
  for (std::size_t f = 0; f < (cell.of_a ? pair.a : pair.b).face_normals.size() && left; ++f) {
    const Plane other = plane_of(pair, cell.of_a, f);
    if (f != cell.face) left = solid.clip({other.normal - own.normal, other.offset - own.offset});
  }
  return left ? solid.volume() : Volume{};
}

void check_cells(const PolyhedronPair& pair, const std::vector<OverlapCell>& cells, double depth) {
  double whole = 0.0, of_a = 0.0;
  for (const OverlapCell& c : cells) {
    whole += 0.5 * c.volume;
    of_a += c.of_a ? c.volume : 0.0;
  }
  CHECK(of_a == Approx(whole).epsilon(3e-14 / depth));  // both fields fill the overlap
  for (const OverlapCell& c : cells) {
    const Volume reference = cell_by_cutting(pair, c);
    CHECK(std::abs(c.volume - reference.volume) <= 3e-14 / depth * whole);
    if (!(c.volume > 1e-3 * whole)) continue;
    CHECK((c.centroid - reference.centroid()).norm() < 1e-9 * std::sqrt(depth));
    CHECK(c.depth == Approx(-plane_of(pair, c.of_a, c.face).above(reference.centroid())).epsilon(1e-12 / depth));
  }
}

/// Pushed together along the axis, which may turn on the way.
PolyhedronPair overlapping(const ConvexHull& a, const ConvexHull& b, double depth, Random& random) {
  Pose pose{2.0 * testing::random_direction(random), testing::random_turn(random)};
  for (int step = 0; step < 4; ++step) {
    const SeparatingAxis axis = polyhedron_distance(PolyhedronPair(a.view(), b.view(), {}, pose)).axis;
    pose.position -= (axis.gap + depth) * axis.normal;
  }
  return {a.view(), b.view(), {}, pose};
}

}  // namespace

TEST_CASE("edges that cross at right angles enclose a tetrahedron of 2/3 d^3, halved by both fields",
          "[detection][volume]") {
  const Box cube(Vec3(0.5, 0.5, 0.5));
  const double half_diagonal = std::sqrt(0.5);
  for (const double d : {0.1, 1e-3, 1e-6}) {
    const Pose a{Vec3::Zero(), on_an_edge(0.0)},
        b{Vec3(0.02, -0.03, 2.0 * half_diagonal - d), on_an_edge(std::acos(0.0))};
    const PolyhedronPair pair(cube.view(), cube.view(), a, b);
    std::vector<OverlapCell> cells;
    const OverlapForm form = form_of(polyhedron_distance(pair).axis);
    REQUIRE(form.kind == FormKind::edges);
    REQUIRE(find_cells(pair, form, cells));
    REQUIRE(cells.size() == 4);
    const double epsilon = 1e-14 / d;  // rounding of places over the thickness
    for (const OverlapCell& c : cells) {
      CHECK(c.volume == Approx(d * d * d / 3.0).epsilon(epsilon));     // opposite edges 2 d and 2 d, d apart
      CHECK(c.depth == Approx(d / std::sqrt(32.0)).epsilon(epsilon));  // d/sqrt(2) at the one corner that is inside
    }
  }
}

TEST_CASE("a cube's corner in a face is a pyramid of sqrt(3)/2 d^3, in three parts of the one field",
          "[detection][volume]") {
  const Box cube(Vec3(0.5, 0.5, 0.5));
  for (const double d : {0.1, 1e-3, 1e-6}) {
    const Pose below{Vec3(0.1, 0.05, -0.5), Quat(1, 0, 0, 0)}, above{Vec3(0, 0, std::sqrt(0.75) - d), on_a_corner()};
    const double volume = std::sqrt(0.75) * d * d * d, epsilon = 1e-14 / d;
    for (const bool corner_is_a : {true, false}) {
      const PolyhedronPair pair(cube.view(), cube.view(), corner_is_a ? above : below, corner_is_a ? below : above);
      std::vector<OverlapCell> cells;
      const OverlapForm form = form_of(polyhedron_distance(pair).axis);
      REQUIRE(form.kind == (corner_is_a ? FormKind::vertex_face : FormKind::face_vertex));
      REQUIRE(find_cells(pair, form, cells));
      REQUIRE(cells.size() == 4);
      for (const OverlapCell& c : cells) {
        const bool part = c.of_a == corner_is_a;
        CHECK(c.volume == Approx(part ? volume / 3.0 : volume).epsilon(epsilon));
        // the corner's centroid is at 3/4 of its height; a part's depth is a quarter of that where the diagonal passes
        CHECK(c.depth == Approx(part ? 0.25 * d / std::sqrt(3.0) : 0.25 * d).epsilon(epsilon));
      }
    }
    const Vec3 up = above.orientation.conjugate() * Vec3::UnitZ();
    const std::uint32_t lowest = ConvexHull::support_vertex(cube.view(), -up);
    const Volume v = corner_below(cube.view(), lowest, up, -d);
    CHECK(v.volume == Approx(volume).epsilon(epsilon));
    CHECK(up.dot(v.centroid() - cube.hull.vertices[lowest]) == Approx(0.75 * d).epsilon(epsilon));
  }
  // deeper than the neighbours the part below is no pyramid
  CHECK(corner_below(cube.view(), 0, -cube.hull.vertices[0].normalized(), -0.6).volume == 0.0);
}

TEST_CASE("every cell of a form is the one that cutting by all planes leaves", "[detection][volume]") {
  Random random(23, 0);
  std::array<int, 5> found{};
  for (const double depth : {3e-2, 1e-3, 1e-5, 1e-6})
    for (int k = 0; k < 200; ++k) {
      const ConvexHull a = support::random_hull(random, 10 + k % 8),
                       b = support::random_hull(random, 8 + k % 9, {1, 0.7, 0.5});
      const PolyhedronPair pair = overlapping(a, b, depth, random);
      const OverlapForm form = form_of(polyhedron_distance(pair).axis);
      std::vector<OverlapCell> cells;
      if (!find_cells(pair, form, cells)) continue;
      ++found[static_cast<std::size_t>(form.kind)];
      INFO(depth << " " << k);
      check_cells(pair, cells, depth);
    }
  CHECK(found[1] > 100);
  CHECK(found[2] > 40);
  CHECK(found[3] > 40);
}

TEST_CASE("cells between near faces are those that cutting by all planes leaves", "[detection][volume]") {
  Random random(37, 0);
  int found = 0, refused = 0;
  for (const double depth : {0.1, 1e-2, 1e-4})
    for (int k = 0; k < 300; ++k) {
      // flat bodies whose faces lean little against each other meet in many ways at once
      const ConvexHull a = support::random_hull(random, 10 + k % 8, {1, 1, 0.4}),
                       b = support::random_hull(random, 8 + k % 9, {1, 0.7, 0.5});
      const PolyhedronPair pair = overlapping(a, b, depth, random);
      ClippedSolid solid;
      if (!cut_overlap(pair, solid)) continue;
      std::vector<Vec3> points;
      for (std::size_t i = 0; i < solid.points(); ++i) points.push_back(solid.point(i));
      const NearFaces near = near_faces(pair, points);
      std::vector<OverlapCell> cells;
      refused += near.count_a > 0 && !find_cells(pair, near, cells);
      if (!find_cells(pair, near, cells)) continue;
      ++found;
      INFO(depth << " " << k);
      check_cells(pair, cells, depth);
      // neither a face less nor one more is taken for the answer
      NearFaces less = near, more = near;
      --less.count_a;
      CHECK(!find_cells(pair, less, cells));
      std::uint16_t other = 0;
      while (std::find(near.b.begin(), near.b.begin() + near.count_b, other) != near.b.begin() + near.count_b) ++other;
      if (more.count_b == NearFaces::most) continue;
      more.b[more.count_b++] = other;
      CHECK(!find_cells(pair, more, cells));
    }
  CHECK(found > 60);
  CHECK(refused > 0);  // faces without a common point are left to cutting
}

TEST_CASE("cells do not show what a pair remembers", "[detection][volume]") {
  Random random(29, 0);
  std::array<int, 5> recalled{};
  int lost = 0;
  for (int k = 0; k < 60; ++k) {
    const ConvexHull a = support::random_hull(random, 9 + k % 8), b = support::random_hull(random, 8 + k % 9);
    Pose pose{1.8 * testing::random_direction(random), testing::random_turn(random)};
    const Vec3 sliding = testing::random_direction(random);
    PairCache cache;
    for (int step = 0; step < 80; ++step) {
      // slides and rolls over the other body, a little in it or just off it: features come and go
      pose.orientation = Quat(Eigen::AngleAxisd(2e-3, sliding)) * pose.orientation;
      pose.position += 5e-3 * sliding;
      const SeparatingAxis axis = polyhedron_distance(PolyhedronPair(a.view(), b.view(), {}, pose)).axis;
      pose.position -= (axis.gap + random.uniform(-2e-4, 2e-3)) * axis.normal;
      const OverlapForm before = cache.made().form;
      const ContactSet with = contacts(a, {}, b, pose, &cache), without = contacts(a, {}, b, pose, nullptr);
      REQUIRE(same_contacts(with, without));
      const OverlapForm after = cache.made().form;
      const bool same = before.kind == after.kind && before.a == after.a && before.b == after.b &&
                        before.near.count_a == after.near.count_a && before.near.count_b == after.near.count_b;
      if (same) ++recalled[static_cast<std::size_t>(after.kind)];
      lost += !same;
    }
  }
  CHECK(recalled[1] > 300);
  CHECK(recalled[2] > 100);
  CHECK(recalled[3] > 100);
  CHECK(recalled[4] > 100);
  CHECK(lost > 300);
}

TEST_CASE("a memory of other bodies does no harm", "[detection][volume]") {
  Random random(41, 0);
  for (int k = 0; k < 40; ++k) {
    const ConvexHull large = support::random_hull(random, 40), small = support::random_hull(random, 5);
    PairCache cache;
    for (const bool first_large : {true, false})
      for (const bool second_large : {true, false}) {
        const ConvexHull &a = first_large ? large : small, &b = second_large ? large : small;
        const PolyhedronPair pair = overlapping(a, b, 1e-3, random);
        const Pose pose{pair.offset, Quat(pair.rotation)};
        CHECK(same_contacts(contacts(a, {}, b, pose, &cache), contacts(a, {}, b, pose, nullptr)));
      }
  }
}

TEST_CASE("a form is found from the faces that bound an overlap, where its axis is another", "[detection][volume]") {
  Random random(31, 0);
  int forms = 0;
  for (int k = 0; k < 300; ++k) {
    const ConvexHull a = support::random_hull(random, 12), b = support::random_hull(random, 10);
    Pose pose{2.0 * testing::random_direction(random), testing::random_turn(random)};
    const SeparatingAxis apart = polyhedron_distance(PolyhedronPair(a.view(), b.view(), {}, pose)).axis;
    pose.position -= (apart.gap + 1e-3) * apart.normal;
    const PolyhedronPair pair(a.view(), b.view(), {}, pose);
    const SeparatingAxis axis = polyhedron_distance(pair).axis;
    std::vector<OverlapCell> cells;
    if (!find_cells(pair, form_of(axis), cells)) continue;
    ++forms;
    SeparatingAxis other = axis;  // along the same direction, with features that make no form
    other.kind = SeparatingAxis::Kind::points;
    ContactSet set, again;
    for (ContactSet* s : {&set, &again}) s->with_area = s->with_curvature = true;
    ContactSink sink(set), sink_again(again);
    sink.begin(0, 1);
    sink_again.begin(0, 1);
    const OverlapForm found = collide_volumes(pair, axis, {1.0, Mat3::Identity()}, sink);
    const OverlapForm found_again = collide_volumes(pair, other, {1.0, Mat3::Identity()}, sink_again);
    CHECK((found.kind == found_again.kind && found.a == found_again.a && found.b == found_again.b));
    CHECK(same_contacts(set, again));
  }
  CHECK(forms > 60);
}
