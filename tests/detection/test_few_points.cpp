// A body of several parts, or on a surface of several walls, rests on four points that span its outline.
#include "detection/narrow/few_points.h"

#include <algorithm>

#include "detection/narrow/narrow_phase.h"
#include "engine/units/random.h"
#include "tests/detection/framed_world.h"
#include "tests/detection/mesh_floors.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"
#include "tests/support/united_contacts.h"

using namespace epafi;

namespace {

/// Boxes on cells of a lattice, all standing on z = 0: angles, rings, trays, whatever comes.
SolidParts random_cells(Random& random) {
  SolidParts solid;
  const double width = random.uniform(0.05, 0.3);
  Vec3 middle = Vec3::Zero();
  std::vector<std::pair<Vec3, Vec3>> boxes;  // centre, half size
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      if (random.uniform() < 0.5 || i + j == 0) {
        const double high = random.uniform(0.5, 1.5) * width;
        boxes.push_back({Vec3(i * width, j * width, 0.5 * high), 0.5 * Vec3(width, width, high)});
        middle += boxes.back().first;
      }
  middle /= static_cast<double>(boxes.size());
  for (const auto& [centre, half] : boxes) solid.parts.push_back({Box(half).hull, centre - middle});
  for (const auto& [centre, half] : boxes)
    solid.radius = std::max(solid.radius, (centre - middle).norm() + half.norm());
  solid.equal_radius = width;
  return solid;
}

double lowest(const SolidParts& solid) {
  double low = infinity;
  for (const auto& part : solid.parts)
    for (const Vec3& v : part.hull.vertices) low = std::min(low, (part.centre + v).z());
  return low;
}

double area_of(const std::vector<Vec3>& points, const Vec3& up) {
  double area = 0.0;  // of at most four corners: all ways of going round
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k) {
        area = std::max(area, 0.5 * std::abs((points[j] - points[i]).cross(points[k] - points[i]).dot(up)));
        for (std::size_t l = k + 1; l < n; ++l) {
          const auto quad = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
            return 0.5 * std::abs((c - a).cross(d - b).dot(up));
          };
          area = std::max({area, quad(points[i], points[j], points[k], points[l]),
                           quad(points[i], points[k], points[j], points[l]),
                           quad(points[i], points[j], points[l], points[k])});
        }
      }
  return area;
}

struct Floor : testing::FramedWorld {
  Floor(Random& random, double distance) {
    frame = {distance * testing::random_direction(random), testing::random_turn(random)};
  }
  /// Of the last body with all others.
  ContactSet contacts() { return testing::united_contacts_of_last(world, shapes); }
  Vec3 up() const { return frame.orientation * Vec3::UnitZ(); }
};

/// At most four, all as deep, in different places; their area.
double check_four(const Floor& floor, const ContactSet& found, double depth) {
  REQUIRE(found.size() >= 3);
  CHECK(found.size() <= 4);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(std::abs(found.gap[i] + depth) < 1e-12 * (1.0 + floor.frame.position.norm()));
    CHECK(found.normal[i].dot(floor.up()) > 1.0 - 1e-9);
    for (const Vec3& p : points) CHECK((p - found.point(i, floor.world)).norm() > 1e-3);
    points.push_back(found.point(i, floor.world));
  }
  return area_of(points, floor.up());
}

}  // namespace

TEST_CASE("a solid of parts rests on a plane, a box or a mesh with four points", "[detection][few-points]") {
  Random random(641, 20);
  for (int k = 0; k < 120; ++k) {
    Floor floor(random, k % 2 == 0 ? 0.0 : std::pow(10.0, random.uniform(0, 3)));
    const SolidParts solid = random_cells(random);
    const double depth = random.uniform(1e-6, 1e-4);
    if (k % 3 == 0) floor.add(HalfSpace{}, {});
    if (k % 3 == 1) floor.add(Box(Vec3(3, 3, 1)), {Vec3(0, 0, -1), Quat(1, 0, 0, 0)});
    if (k % 3 == 2) {
      TriangleSurface ground;
      ground.vertices = {{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}, {random.uniform(), random.uniform(), 0}};
      ground.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
      floor.add(TriangleMesh::from_surface(ground), {});
    }
    floor.add(solid,
              {Vec3(random.uniform(-1, 1), random.uniform(-1, 1), -lowest(solid) - depth),
               Quat(Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitZ()))},
              1.0);
    const double area = check_four(floor, floor.contacts(), depth);
    // at least half of what the outline spans: that of four out of its corners
    double outline = 0.0;
    std::vector<Vec3> corners;
    for (const auto& part : solid.parts)
      for (const Vec3& v : part.hull.vertices) corners.push_back(part.centre + v);
    for (std::size_t i = 0; i < 200; ++i) {
      std::vector<Vec3> any;
      for (int n = 0; n < 4; ++n) any.push_back(corners[random.bits() % corners.size()]);
      for (Vec3& p : any) p.z() = 0.0;
      outline = std::max(outline, area_of(any, Vec3::UnitZ()));
    }
    INFO("draw " << k << ", parts " << solid.parts.size());
    CHECK(area >= 0.5 * outline);
  }
}

TEST_CASE("a box over several fixed tiles rests on four points; over free ones it keeps its points on each",
          "[detection][few-points][seams]") {
  Random random(641, 21);
  int whole = 0;
  for (int k = 0; k < 100; ++k) {
    const bool free = k % 4 == 3;
    Floor floor(random, k % 2 == 0 ? 0.0 : 100.0);
    const double width = random.uniform(0.1, 0.4), depth = random.uniform(1e-6, 1e-5);
    for (int i = -2; i <= 2; ++i)
      for (int j = -1; j <= 1; ++j)
        floor.add(Box(Vec3(0.5 * width, 0.5, 0.05)), {Vec3(i * width, j, -0.05), Quat(1, 0, 0, 0)}, free ? 1.0 : 0.0);
    const Vec3 half(random.uniform(0.5, 0.9) * width, 0.1, 0.1);
    floor.add(Box(half),
              {Vec3(random.uniform(-0.5, 0.5) * width, random.uniform(-1, 1), 0.1 - depth),
               Quat(Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitZ()))},
              1.0);
    const ContactSet found = floor.contacts();
    INFO("draw " << k);
    if (free) {
      CHECK(found.size() >= 4);
    } else {
      // a tile on which the box has more than four points may have let go of its corner
      const double share = check_four(floor, found, depth) / (4.0 * half.x() * half.y());
      CHECK(share > 0.6);
      whole += share > 1.0 - 1e-6;
    }
  }
  CHECK(whole > 50);
}

TEST_CASE("what remains does not depend on tremor, and is the same surface for the memory of contacts",
          "[detection][few-points]") {
  Random random(641, 22);
  for (int k = 0; k < 40; ++k) {
    const SolidParts solid = random_cells(random);
    std::vector<Feature> kept;
    for (int tremor = 0; tremor < 5; ++tremor) {
      Random same(641, 23);
      Floor f(same, 1.0);
      f.add(HalfSpace{}, {});
      const Vec3 slip = 1e-10 * testing::random_point(random);
      f.add(solid,
            {Vec3(0, 0, -lowest(solid) - 1e-5) + slip,
             Quat(Eigen::AngleAxisd(1e-10 * random.uniform(), testing::random_direction(random)))},
            1.0);
      const ContactSet found = f.contacts();
      if (tremor == 0) kept = found.feature;
      CHECK(found.feature == kept);
      if (solid.parts.size() > 1) CHECK(found.joined.size() == 1);
    }
  }
}
