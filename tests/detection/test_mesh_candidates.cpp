// What a body feels of a mesh does not depend on which far triangles are looked at beside the near ones.
#include "detection/narrow/mesh/mesh_pairs.h"
#include "detection/narrow/narrow_phase.h"
#include "detection/shapes/box.h"
#include "detection/shapes/cylinder.h"
#include "detection/shapes/ellipsoid.h"
#include "tests/detection/mesh_floors.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// Walls of squares on edge and steps between them: convex, concave and flat edges, all corners shared or none.
TriangleSurface steps(Random& random, bool shared) {
  TriangleSurface s = floor_surface(random, 8, shared ? Joints::shared : Joints::loose);
  for (Vec3& v : s.vertices) v.z() = 0.1 * std::floor(3.0 * std::abs(std::sin(5.0 * v.x()) * std::cos(4.0 * v.y())));
  return s;
}

template <class S>
void check_any_candidates(const S& shape, const TriangleMesh& mesh, Random& random) {
  for (int k = 0; k < 150; ++k) {
    const Pose body{{random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), random.uniform(0.0, 0.4)},
                    random_turn(random)};
    const auto from = [&](double margin) {
      ContactSet set;
      ContactSink sink(set);
      std::vector<std::uint32_t> triangles;
      mesh.query(shape.bounding_box(body).fattened(margin), triangles);
      sink.begin(0, 1);
      collide_triangles(shape, mesh, triangles, {body, {}, 0.01, false, nullptr}, sink);
      sink.end();
      return set;
    };
    const ContactSet few = from(0.0101);
    for (const double margin : {0.1, 5.0}) {
      const ContactSet many = from(margin);
      CHECK(few.gap == many.gap);
      CHECK(few.feature == many.feature);
      REQUIRE(few.size() == many.size());
      for (std::size_t i = 0; i < few.size(); ++i)
        CHECK((few.normal[i] == many.normal[i] && few.arm[i] == many.arm[i]));
    }
  }
}

}  // namespace

TEST_CASE("contacts with a mesh are the same bits with any list of candidates", "[detection][mesh-pairs]") {
  Random random(64, 0);
  for (const bool shared : {true, false}) {
    const TriangleMesh mesh = TriangleMesh::from_surface(steps(random, shared));
    check_any_candidates(Sphere{0.08}, mesh, random);
    check_any_candidates(Box(Vec3(0.06, 0.08, 0.1)), mesh, random);
    check_any_candidates(Cylinder(0.06, 0.15), mesh, random);
    check_any_candidates(Ellipsoid(Vec3(0.05, 0.08, 0.12)), mesh, random);
  }
}

TEST_CASE("a cylinder on a regular floor, aligned with its triangles, stands on it everywhere",
          "[detection][mesh-pairs]") {
  Random random(63, 0);
  TriangleSurface s;
  for (std::uint32_t j = 0; j <= 40; ++j)
    for (std::uint32_t i = 0; i <= 40; ++i) s.vertices.push_back({-1 + 0.05 * i, -1 + 0.05 * j, 0.0});
  for (std::uint32_t j = 0; j < 40; ++j)
    for (std::uint32_t i = 0; i < 40; ++i) {
      const std::uint32_t k = j * 41 + i;
      s.triangles.push_back({k, k + 1, k + 42});
      s.triangles.push_back({k, k + 42, k + 41});
    }
  const TriangleMesh mesh = TriangleMesh::from_surface(s);
  for (int k = 0; k < 300; ++k) {
    const Pose body{Vec3(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 0.0499), Quat(1, 0, 0, 0)};
    const ContactSet c = contacts_with(Cylinder(0.05, 0.1), body, mesh);
    CHECK(c.size() >= 3);
    for (std::size_t i = 0; i < c.size(); ++i) {
      CHECK(c.gap[i] == Approx(-1e-4).epsilon(1e-10));
      CHECK((c.normal[i] + Vec3::UnitZ()).norm() < 1e-14);
      CHECK(c.arm[i].norm() < 0.0708);  // within the cylinder
    }
  }
}

TEST_CASE("through the narrow phase the mesh may be A or B, and remembered candidates change nothing",
          "[detection][mesh-pairs]") {
  Random random(62, 0);
  ShapeStore shapes;
  const ShapeRef floor = shapes.add(TriangleMesh::from_surface(floor_surface(random, 20)));
  const ShapeRef sphere = shapes.add(Sphere{0.1}), box = shapes.add(Box(Vec3(0.1, 0.1, 0.1)));
  const auto build = [&](bool mesh_first) {
    World world(Columns{.rotation = true});
    const Body mesh{.shape = floor.packed};
    if (mesh_first) world.add(mesh);
    for (const auto& [shape, x] : {std::pair{sphere, -0.5}, {box, 0.5}})
      world.add({.position = Vec3(x, 0.1, 0.099), .mass = 1.0, .inertia = Vec3(1, 1, 1), .shape = shape.packed});
    if (!mesh_first) world.add(mesh);
    return world;
  };
  const auto detect = [&](bool mesh_first) {
    const World world = build(mesh_first);
    PairList list;
    list.margin = 0.01;
    list.generation = 1;
    if (mesh_first)
      list.pairs = {{0, 1}, {0, 2}};
    else
      list.pairs = {{0, 2}, {1, 2}};
    BatchNarrowPhase narrow(shapes, 0.0, true);
    ContactSet contacts;
    narrow.collide(world, list, contacts);
    ContactSet again;
    narrow.collide(world, list, again);  // with the candidates of the first call
    CHECK(again.gap == contacts.gap);
    CHECK(again.feature == contacts.feature);
    return contacts;
  };
  const ContactSet ahead = detect(true), behind = detect(false);
  REQUIRE(ahead.size() == 5);
  REQUIRE(behind.size() == 5);
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(ahead.gap[k] == Approx(-0.001).epsilon(1e-9));
    CHECK((ahead.normal[k] - Vec3(0, 0, 1)).norm() < 1e-12);  // from the mesh (A) to the body
    CHECK((behind.normal[k] - Vec3(0, 0, -1)).norm() < 1e-12);
    CHECK(ahead.feature[k] == behind.feature[k]);
    const Vec3 body = k == 0 ? Vec3(-0.5, 0.1, 0.099) : Vec3(0.5, 0.1, 0.099);
    CHECK((ahead.arm[k] - (behind.arm[k] + body)).norm() < 1e-15);  // from the mesh's origin, from the body's centre
  }
}
