// The loops over four vertices, faces or edges at a time, against loops over one at a time, on every instruction set
// that this processor runs.
#include "detection/narrow/polyhedra/gauss_arcs.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"

using namespace epafi;
using testing::random_direction;
using testing::random_turn;

namespace {

/// Bodies of every number of lanes left over: 4 to 40 vertices, and boxes with exact ties.
std::vector<ConvexHull> bodies(Random& random) {
  std::vector<ConvexHull> out{Box(Vec3(0.5, 0.4, 0.3)).hull, support::unit_tetrahedron()};
  for (std::size_t n = 4; n <= 40; n += 3) out.push_back(support::random_hull(random, n));
  return out;
}

std::vector<Arc> arcs_of(const ConvexHull& h, const Mat3& rotation, const Vec3& offset, double sign) {
  std::vector<Arc> out;
  for (const HullEdge& e : h.edges)
    out.push_back({rotation * h.vertices[e.from] + offset, rotation * (h.vertices[e.to] - h.vertices[e.from]),
                   sign * (rotation * h.face_normals[e.left]), sign * (rotation * h.face_normals[e.right])});
  return out;
}

/// Separation along the axis across both edges, outward of the first; NaN where the arcs do not cross.
double separation_across(const Arc& a, const Arc& b) {
  if (!arcs_cross({a.along, a.left, a.right, 0}, {b.along, b.left, b.right, 0})) return std::nan("");
  Vec3 n = a.along.cross(b.along).normalized();
  if (n.dot(a.left + a.right) < 0.0) n = -n;
  return n.dot(b.from - a.from);
}

static_assert(alignof(VertexLanes) == 32 && alignof(FaceLanes) == 32);
static_assert(alignof(EdgeLanes) == 32 && alignof(ArcLanes) == 32);

}  // namespace

TEST_CASE("the farthest vertex and the heights of faces are those of plain loops, to the bit", "[detection][lanes]") {
  Random random(71, 0);
  REQUIRE(all_hull_kernels().size() >= 1);
  for (const ConvexHull& h : bodies(random))
    for (int k = 0; k < 50; ++k) {
      Vec3 d = random_direction(random);
      if (k % 5 == 0) d = Vec3::Unit(k / 5 % 3);  // ties
      std::uint32_t farthest = 0, highest = 0;
      for (std::uint32_t v = 1; v < h.vertices.size(); ++v)
        if (d.dot(h.vertices[v]) > d.dot(h.vertices[farthest])) farthest = v;
      std::vector<double> height;
      for (std::uint32_t f = 0; f < h.face_normals.size(); ++f) {
        height.push_back(h.face_normals[f].dot(d) - h.face_offsets[f]);
        if (height[f] > height[highest]) highest = f;
      }
      for (const HullKernels& loops : all_hull_kernels()) {
        INFO(loops.name);
        std::vector<double> found(lane_count * h.lanes.faces.size());
        CHECK(loops.farthest(h.lanes.vertices, d) == farthest);
        CHECK(loops.heights(h.lanes.faces, d, found.data()) == highest);
        CHECK(std::equal(height.begin(), height.end(), found.begin()));
        for (std::size_t f = height.size(); f < found.size(); ++f) CHECK(found[f] == -infinity);
      }
    }
}

TEST_CASE("points below all faces but some are told from others on every instruction set", "[detection][lanes]") {
  Random random(74, 0);
  std::size_t below = 0, tried = 0;
  for (const ConvexHull& h : bodies(random))
    for (int k = 0; k < 40; ++k) {
      const auto faces = static_cast<std::uint32_t>(h.face_normals.size());
      std::vector<Vec3> points;
      for (int i = 0; i < 1 + k % 5; ++i) points.push_back(random.uniform(0.2, 1.0) * random_direction(random));
      std::vector<double> height(faces, -infinity);
      for (std::uint32_t f = 0; f < faces; ++f)
        for (const Vec3& x : points) height[f] = std::max(height[f], h.face_normals[f].dot(x) - h.face_offsets[f]);
      // the highest faces are the own ones; the bound is the height of the next one, or just above it
      std::vector<std::uint32_t> order(faces);
      for (std::uint32_t f = 0; f < faces; ++f) order[f] = f;
      std::sort(order.begin(), order.end(), [&](auto f, auto g) { return height[f] > height[g]; });
      const std::size_t own = static_cast<std::size_t>(k % 4);
      const double next = height[order[own]];
      for (const double least : {next, std::nextafter(next, infinity)}) {
        ++tried;
        below += least > next;
        for (const HullKernels& loops : all_hull_kernels()) {
          INFO(loops.name);
          CHECK(loops.all_below(h.lanes.faces, points, least, {order.data(), own}) == (least > next));
        }
      }
    }
  CHECK(tried == 2 * below);
}

TEST_CASE("faces and edges let through are those of plain loops on every instruction set", "[detection][lanes]") {
  Random random(72, 0);
  std::size_t let = 0, held = 0;
  for (const ConvexHull& h : bodies(random))
    for (int k = 0; k < 30; ++k) {
      const std::size_t faces = lane_count * h.lanes.faces.size();
      std::vector<double> point(faces), centre(faces);
      hull_kernels().heights(h.lanes.faces, 0.6 * random_direction(random), point.data());
      hull_kernels().heights(h.lanes.faces, 0.3 * random_direction(random), centre.data());
      std::vector<std::uint32_t> deepest(h.face_normals.size());
      for (auto& v : deepest) v = random.uniform() < 0.5 ? FaceHeights::unknown : random.uniform() < 0.5 ? 1u : 2u;
      const FaceHeights of{point.data(), centre.data(), deepest.data()};
      const double best = -random.uniform(0.05, 0.6), inner = random.uniform(0.0, 0.8), needed = best + inner;
      std::vector<std::uint32_t> high, edges;
      for (std::uint32_t f = 0; f < h.face_normals.size(); ++f)
        if (point[f] >= best && centre[f] >= needed) high.push_back(f);
      for (std::uint32_t e = 0; e < h.edges.size(); ++e) {
        const auto [from, to, l, r] = h.edges[e];
        if (!(std::max(point[l], point[r]) > best)) continue;
        if (deepest[l] == deepest[r] && deepest[l] != FaceHeights::unknown) continue;
        const double cosine = h.face_normals[l].dot(h.face_normals[r]);
        const bool ends = std::max(centre[l], centre[r]) >= needed;
        const bool between = centre[l] >= cosine * centre[r] && centre[r] >= cosine * centre[l];
        if (needed > 0.0 && !ends && !between) continue;
        edges.push_back(e);
      }
      let += edges.size();
      held += h.edges.size() - edges.size();
      for (const HullKernels& loops : all_hull_kernels()) {
        INFO(loops.name);
        std::vector<std::uint32_t> found(faces);
        found.resize(loops.high_faces(of, h.face_normals.size(), best, needed, found.data()));
        CHECK(found == high);
        found.assign(lane_count * h.lanes.edges.size(), 0);
        found.resize(loops.promising_edges(h.lanes.edges, of, best, inner, 0.0, found.data()));
        std::erase_if(found, [&](std::uint32_t e) { return e >= h.edges.size(); });
        CHECK(found == edges);
      }
    }
  CHECK(let > 200);
  CHECK(held > 2000);
}

TEST_CASE("arcs that cross and separate enough are found four at a time", "[detection][lanes]") {
  Random random(73, 0);
  const std::vector<ConvexHull> all = bodies(random);
  std::size_t crossing = 0;
  for (int k = 0; k < 60; ++k) {
    const auto pick = [&]() -> const ConvexHull& { return all[random.bits() % all.size()]; };
    const ConvexHull &a = pick(), &b = pick();
    const Mat3 turn = random_turn(random).toRotationMatrix();
    const std::vector<Arc> own = arcs_of(a, Mat3::Identity(), Vec3::Zero(), 1.0);
    const std::vector<Arc> others = arcs_of(b, turn, 0.8 * random_direction(random), -1.0);
    std::vector<ArcLanes> held((own.size() + lane_count - 1) / lane_count, ArcLanes{});
    for (std::size_t i = 0; i < own.size(); ++i) held[i / lane_count].set(i % lane_count, own[i]);
    for (const Arc& other : others)
      for (const double least : {-infinity, -0.4, 0.0, 0.2}) {
        std::vector<std::uint32_t> wanted;
        for (std::uint32_t i = 0; i < own.size(); ++i)
          if (separation_across(own[i], other) >= least) wanted.push_back(i);  // never at the bound exactly
        crossing += wanted.size();
        for (const HullKernels& loops : all_hull_kernels()) {
          INFO(loops.name << ", at least " << least);
          std::vector<std::uint32_t> found(lane_count * held.size());
          found.resize(loops.crossing_arcs(held, other, least, found.data()));
          CHECK(found == wanted);
        }
      }
  }
  CHECK(crossing > 1000);
}
