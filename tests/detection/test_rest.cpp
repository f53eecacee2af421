// Bodies at rest tremble by what solvers leave. The points that carry them, and their names, must stay the same: warm
// starts and springs ride on them.
#include "detection/narrow/narrow_phase.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"

using namespace epafi;
using testing::random_direction;
using testing::upright;

namespace {

/// A shape, how it lies on a plane, and how high its centre is then.
struct Lying {
  const char* name;
  std::function<ShapeRef(ShapeStore&)> add;
  Quat turn;
  double height;
  std::size_t points;  ///< at least
};

/// Lowest face of a hull: the largest one.
Quat onto_largest_face(const ConvexHull& h, double& height) {
  double largest = 0.0;
  Vec3 down = Vec3::UnitZ();
  for (std::size_t f = 0; f < h.face_normals.size(); ++f) {
    Vec3 area = Vec3::Zero();
    for (std::uint32_t k = h.face_begin[f] + 1; k + 1 < h.face_begin[f + 1]; ++k) {
      const Vec3& first = h.vertices[h.face_vertices[h.face_begin[f]]];
      area += (h.vertices[h.face_vertices[k]] - first).cross(h.vertices[h.face_vertices[k + 1]] - first);
    }
    if (area.norm() > largest) {
      largest = area.norm();
      down = h.face_normals[f];
      height = h.face_offsets[f];
    }
  }
  return Quat::FromTwoVectors(down, -Vec3::UnitZ());
}

std::vector<Lying> lying_bodies() {
  Random random(91, 0);
  std::vector<Lying> out;
  const auto keep = [&](const char* name, auto shape, const Quat& turn, double height, std::size_t points) {
    out.push_back({name, [shape](ShapeStore& s) { return s.add(shape); }, turn, height, points});
  };
  keep("cube", Box(Vec3::Constant(0.1)), upright, 0.1, 4);
  keep("brick", Box(Vec3(0.2, 0.1, 0.05)), Quat(Eigen::AngleAxisd(0.3, Vec3::UnitZ())), 0.05, 4);
  for (const std::size_t n : {8u, 64u}) {
    const ConvexHull hull = support::random_hull(random, n, Vec3(0.2, 0.15, 0.1));
    double height = 0.0;
    const Quat turn = onto_largest_face(hull, height);
    keep(n == 8 ? "hull of 8" : "hull of 64", hull, turn, height, 3);
  }
  keep("cylinder", Cylinder(0.1, 0.2), upright, 0.1, 3);
  keep("lying cylinder", Cylinder(0.1, 0.2), Quat(Eigen::AngleAxisd(2 * std::atan(1.0), Vec3::UnitY())), 0.1, 2);
  keep("capsule", Capsule(0.1, 0.2), Quat(Eigen::AngleAxisd(2 * std::atan(1.0), Vec3::UnitY())), 0.1, 2);
  return out;
}

/// A square floor at z = 0: nodes of a lattice, shifted where irregular.
TriangleMesh floor_mesh(int n, double irregular) {
  Random random(92, 0);
  TriangleSurface s;
  const double cell = 2.0 / n;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      s.vertices.push_back({-1 + cell * (i + irregular * random.uniform(-1, 1)),
                            -1 + cell * (j + irregular * random.uniform(-1, 1)), 0.0});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::uint32_t>(j * (n + 1) + i), row = static_cast<std::uint32_t>(n + 1);
      s.triangles.push_back({k, k + 1, k + row + 1});
      s.triangles.push_back({k, k + row + 1, k + row});
    }
  return TriangleMesh::from_surface(s);
}

/// B trembles on A; the names must be those of the first look, whatever memory the pair has.
void tremble(World& world, ShapeStore& shapes, std::size_t points) {
  BatchNarrowPhase narrow(shapes, 0.0, false);
  const PairList pairs{{{0, 1}}, 0.01, 1};
  const Vec3 position = world.position[1];
  const Quat turn = world.orientation[1];
  ContactSet first, now;
  narrow.collide(world, pairs, first);
  CHECK(first.size() >= points);
  Random random(93, 0);
  int changed = 0;
  for (int k = 0; k < 200; ++k) {
    world.position[1] = position + 1e-9 * random_direction(random);
    world.orientation[1] = Quat(Eigen::AngleAxisd(1e-9, random_direction(random))) * turn;
    narrow.collide(world, pairs, now);
    changed += now.feature != first.feature;
  }
  CHECK(changed == 0);
}

Body body_of(ShapeRef shape, const Vec3& position, const Quat& turn) {
  Body b;
  b.position = position;
  b.orientation = turn;
  b.mass = 1.0;
  b.inertia = Vec3::Ones();
  b.shape = shape.packed;
  return b;
}

constexpr double sunk = 1e-6;  // of bodies of 0.2 m

void lie_on_floors(bool standing_cylinder) {
  for (const Lying& l : lying_bodies())
    for (const char* floor : {"plane", "table", "coarse mesh", "fine mesh", "irregular mesh"}) {
      if ((l.name == std::string("cylinder")) != standing_cylinder) continue;
      INFO(l.name << " on a " << floor);
      const std::string kind = floor;
      ShapeStore shapes;
      World world{Columns{.rotation = true}};
      const ShapeRef below = kind == "plane"         ? shapes.add(HalfSpace{Vec3::UnitZ()})
                             : kind == "table"       ? shapes.add(Box(Vec3(1, 1, 0.25)))
                             : kind == "coarse mesh" ? shapes.add(floor_mesh(2, 0.0))
                             : kind == "fine mesh"   ? shapes.add(floor_mesh(40, 0.0))
                                                     : shapes.add(floor_mesh(30, 0.3));
      world.add(body_of(below, {0, 0, kind == "table" ? -0.25 : 0.0}, upright));
      world.add(body_of(l.add(shapes), {0.137, -0.211, l.height - sunk}, l.turn));
      tremble(world, shapes, l.points);
    }
}

}  // namespace

TEST_CASE(
    "boxes, hulls and lying bodies at rest on planes, tables and floors of triangles keep the names of their points",
    "[detection][manifold][rest]") {
  lie_on_floors(false);
}

TEST_CASE("a standing cylinder keeps the names of its points", "[detection][manifold][rest]") { lie_on_floors(true); }

TEST_CASE("bodies at rest on their like keep the names of their points", "[detection][manifold][rest]") {
  const Quat over(Eigen::AngleAxisd(4 * std::atan(1.0), Vec3::UnitX()));  // the face that carries looks up
  for (const Lying& l : lying_bodies())
    for (const Vec3& aside : {Vec3(0, 0, 0), Vec3(0.013, 0.021, 0)})
      for (const double turn : {0.0, 0.4}) {
        const Vec3 along(aside.x(), l.points == 2 ? 0.0 : aside.y(),
                         0.0);  // what lies on its side touches along x only
        INFO(l.name << " aside by " << along.transpose() << ", turned by " << turn);
        ShapeStore shapes;
        World world{Columns{.rotation = true}};
        const ShapeRef shape = l.add(shapes);
        world.add(body_of(shape, {0, 0, -l.height}, over * l.turn));
        world.add(
            body_of(shape, Vec3(0, 0, l.height - sunk) + along, Quat(Eigen::AngleAxisd(turn, Vec3::UnitZ())) * l.turn));
        tremble(world, shapes, 1);
      }
}
