#include "viz_export/vtk/frame_writer.h"

#include "engine/state/state_snapshot.h"
#include "engine/step/energy.h"
#include "tests/support/catch.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"

using namespace epafi;

namespace {

template <class T>
const VtpColumn<T>& values(const std::vector<VtpArray>& arrays, const std::string& name) {
  for (const VtpArray& a : arrays)
    if (a.name == name) return std::get<VtpColumn<T>>(a.values);
  throw std::runtime_error("no array " + name);
}

std::size_t count_files(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace

TEST_CASE("records follow body ids, not slots, and their kinetic energies sum to the ledger's",
          "[viz_export][frames]") {
  SmallScene scene(20);
  std::vector<Slot> backwards;
  for (Slot s = 21; s-- > 0;) backwards.push_back(s);
  scene.world.reorder(backwards);
  SurfaceCache surfaces(scene.shapes);
  const auto bodies = body_records(scene.world, surfaces);
  REQUIRE(bodies.size() == 21);
  double sum = 0.0;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    CHECK(bodies[k].id == k);
    sum += bodies[k].kinetic_energy;
  }
  CHECK(bodies[3].pose.position == Vec3(2, 4, 0.5));
  CHECK(bodies[3].radius == 0.1 + 0.01 * 2);
  CHECK((bodies[0].is_wall() && bodies[0].surface != nullptr && bodies[3].surface == nullptr));
  CHECK(sum == Approx(kinetic_energy(scene.world)).epsilon(1e-14));
}

TEST_CASE("spheres are drawn as points that carry their numbers", "[viz_export][frames]") {
  SmallScene scene(3);
  SurfaceCache surfaces(scene.shapes);
  auto bodies = body_records(scene.world, surfaces);
  bodies.erase(bodies.begin());
  const PolyData d = draw_spheres(bodies, 0.5, {0, bodies.size()});
  CHECK(d.points == VtpColumn<float>{0, 0, 0.5f, 1, 2, 0.5f, 2, 4, 0.5f});
  CHECK(d.vertices.connectivity == VtpColumn<std::int32_t>{0, 1, 2});
  CHECK(d.vertices.offsets == VtpColumn<std::int32_t>{1, 2, 3});
  CHECK(values<std::uint32_t>(d.point_data, "id") == VtpColumn<std::uint32_t>{1, 2, 3});
  CHECK(values<float>(d.point_data, "radius") == VtpColumn<float>{0.1f, 0.11f, 0.12f});
  CHECK(values<float>(d.point_data, "velocity")[4] == 1.0f);
  CHECK(values<float>(d.point_data, "speed")[2] == static_cast<float>(std::sqrt(6.0)));  // velocity (1, 2, -1)
}

TEST_CASE("a half-space is drawn as a square on its plane that reaches beyond all bodies", "[viz_export][frames]") {
  SmallScene scene(10);
  scene.world.position[0] = {5, 5, 0.3};
  scene.world.orientation[0] = Quat(std::sqrt(0.5), std::sqrt(0.5), 0, 0);  // z turns to -y
  SurfaceCache surfaces(scene.shapes);
  const auto bodies = body_records(scene.world, surfaces);
  const std::vector<BodyRecord> wall{bodies[0]};
  const PolyData d = draw_surfaces(wall, 0.0);
  REQUIRE(d.points.size() == 12);
  Aabb square;
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(d.points[3 * k + 1] == Approx(5.0).epsilon(1e-6));  // all on y = 5
    square.include(Vec3(d.points[3 * k], d.points[3 * k + 1], d.points[3 * k + 2]));
  }
  CHECK((square.min.x() < -0.1 && square.max.x() > 9.2 && square.min.z() < 0.3 && square.max.z() > 0.7));
  CHECK(d.polygons.offsets == VtpColumn<std::int32_t>{4});
}

TEST_CASE("contacts that touch or carry force are lines between centres, to the contact point at a wall",
          "[viz_export][frames]") {
  SmallScene scene(3);
  const ContactList all(scene.world, {scene.world, scene.contacts});
  REQUIRE((all.size() == 2 && all.begins() == std::vector<std::size_t>{0, 2}));
  ContactRows contacts;
  all.read(0, [&](const ContactRows& rows) { contacts = rows; });
  CHECK((contacts.id_a(0) == 0 && contacts.from(0) == Vec3(0, 0, 0) && contacts.to(0) == Vec3(0, 0, 0.5)));
  CHECK((contacts.normal_force(0) == 7.0 && contacts.overlap(0) == 0.01));
  CHECK((contacts.from(1) == Vec3(0, 0, 0.5) && contacts.to(1) == Vec3(1, 2, 0.5)));
  CHECK(contacts.normal_force(1) == 3.0);  // force on A is (-3, 4, 0), the normal x
  const PolyData d = draw_contacts(contacts, 0.0);
  CHECK(d.points.size() == 12);
  CHECK(values<float>(d.cell_data, "force_magnitude") == VtpColumn<float>{7, 5});
}

TEST_CASE("contacts come in pieces without those that are apart, and rows go on from piece to piece",
          "[viz_export][frames]") {
  SmallScene scene(3);
  scene.contacts = {};
  for (std::size_t k = 0; k < 5 * sum_block; ++k) {
    const bool touches = k / sum_block != 2 && k % 3 == 0;  // nobody in the third piece
    scene.contacts.append(1, 2, {.gap = touches ? -1e-6 * static_cast<double>(k) - 1e-9 : 0.1, .feature = k});
    scene.contacts.force.push_back(Vec3::Zero());
  }
  const ContactList all(scene.world, {scene.world, scene.contacts});
  REQUIRE(all.begins().size() == 5);
  std::vector<double> overlap;
  for (std::size_t piece = 0; piece + 1 < all.begins().size(); ++piece)
    all.read(piece, [&](const ContactRows& rows) {
      CHECK((rows.begin() == all.begins()[piece] && rows.end() == all.begins()[piece + 1]));
      for (std::size_t row = rows.begin(); row < rows.end(); ++row) overlap.push_back(rows.overlap(row));
    });
  CHECK((overlap.size() == all.size() && std::ranges::is_sorted(overlap) && overlap.back() > 1e-6 * 4.9 * sum_block));
  scene.contacts.force.pop_back();  // not evaluated for all
  const ContactList none(scene.world, {scene.world, scene.contacts});
  CHECK((none.size() == 0 && none.begins() == std::vector<std::size_t>{0, 0}));
}

TEST_CASE("bodies that have gone leave no row, and lists of all and of some agree", "[viz_export][frames]") {
  SmallScene scene(6);
  SurfaceCache surfaces(scene.shapes);
  CHECK(BodyList(scene.world, surfaces).size() == 7);
  scene.world.remove(std::vector{BodyId{2}, BodyId{5}});
  const BodyList left(scene.world, surfaces);
  REQUIRE(left.size() == 5);
  const BodyList two = left.only({1, 3});
  REQUIRE(two.size() == 2);
  CHECK((two.id(0) == 1 && two.id(1) == 4 && left.id(4) == 6));
  CHECK((two.position(1) == left.position(3) && two[1].radius == left.radius(3)));
}

TEST_CASE("the spheres of a list are found wherever the other bodies stand", "[viz_export][frames]") {
  SmallScene scene(3);
  SurfaceCache surfaces(scene.shapes);
  const auto add_wall = [&] {
    Body wall;
    wall.shape = scene.shapes.add(HalfSpace{}).packed;
    scene.world.add(wall);
  };
  const auto ids = [&](const std::vector<Slot>& others) {
    const BodyList spheres = BodyList(scene.world, surfaces).spheres(others);
    std::vector<std::uint32_t> out;
    for (std::size_t k = 0; k < spheres.size(); ++k) out.push_back(spheres.id(k));
    return out;
  };
  using Ids = std::vector<std::uint32_t>;
  CHECK(ids({0}) == Ids{1, 2, 3});  // in front
  add_wall();
  CHECK(ids({0, 4}) == Ids{1, 2, 3});  // on both sides
  scene.add_sphere();
  CHECK(ids({0, 4}) == Ids{1, 2, 3, 5});  // between
  scene.world.remove(std::vector{BodyId{2}});
  CHECK(ids({0, 3}) == Ids{1, 3, 5});
  scene.world.remove(std::vector{BodyId{0}});
  CHECK(ids({2}) == Ids{1, 3, 5});
  scene.world.remove(std::vector{BodyId{4}});
  CHECK(ids({}) == Ids{1, 3, 5});
  Body sphere, wall;
  sphere.shape = scene.shapes.add(Sphere{0.1}).packed;
  wall.shape = scene.shapes.add(HalfSpace{}).packed;
  World world;
  for (const Body& body : {sphere, sphere, wall}) world.add(body);
  const BodyList behind = BodyList(world, surfaces).spheres(std::vector<Slot>{2});
  CHECK((behind.size() == 2 && behind.id(0) == 0 && behind.id(1) == 1));
}

TEST_CASE("walls are written again only when they moved, and every time lists one", "[viz_export][frames]") {
  const TemporaryFolder folder;
  SmallScene scene(3);
  SurfaceCache surfaces(scene.shapes);
  FrameWriter frames(folder.path());
  for (int k = 0; k < 4; ++k) {
    scene.world.time = k;
    if (k == 2) scene.world.position[0].z() = -0.5;
    const auto bodies = body_records(scene.world, surfaces);
    frames.write(scene.world.time, bodies, ContactList(scene.world, {scene.world, scene.contacts}));
    frames.write(scene.world.time, bodies, {});  // the same time again: nothing
  }
  CHECK(frames.frames() == 4);
  CHECK(count_files(folder / "frames") == 4 + 4 + 2);  // spheres, contacts, walls
  CHECK(std::filesystem::exists(folder / "frames/walls_000002.vtp"));
  PvdFile list(folder / "frames.pvd");
  list.keep_until(1e9);
  CHECK(list.entries().size() == 12);
  CHECK(list.entries().back().file == "frames/walls_000002.vtp");
}

TEST_CASE("frames continued from a checkpoint are numbered as in an uninterrupted run", "[viz_export][frames]") {
  const TemporaryFolder folder;
  SmallScene scene(3);
  SurfaceCache surfaces(scene.shapes);
  const auto write = [&](FrameWriter& frames, int from, int to) {
    for (int k = from; k < to; ++k) frames.write(0.1 * k, body_records(scene.world, surfaces), {});
  };
  {
    FrameWriter frames(folder.path());
    write(frames, 0, 5);
  }
  FrameWriter resumed(folder.path(), 0.1 * 2);
  CHECK(resumed.frames() == 3);
  write(resumed, 3, 5);
  PvdFile list(folder / "frames.pvd");
  list.keep_until(1e9);
  REQUIRE(list.entries().size() == 15);  // spheres, contacts, walls of each
  CHECK((list.entries()[12].time == 0.1 * 4 && list.entries()[12].file == "frames/spheres_000004.vtp"));
}

TEST_CASE("a run that goes on with its state does not write its walls once more", "[viz_export][frames]") {
  const TemporaryFolder folder;
  SmallScene scene(3);
  SurfaceCache surfaces(scene.shapes);
  StateSnapshot state;
  {
    FrameWriter frames(folder.path());
    for (int k = 0; k < 3; ++k) frames.write(0.1 * k, body_records(scene.world, surfaces), {});
    state.save([&](StateVisitor& v) { frames.visit(v); });
  }
  FrameWriter resumed(folder.path(), 0.1 * 2);
  state.restore([&](StateVisitor& v) { resumed.visit(v); });
  for (int k = 3; k < 5; ++k) resumed.write(0.1 * k, body_records(scene.world, surfaces), {});
  CHECK(count_files(folder / "frames") == 2 * 5 + 1);           // spheres and contacts, walls once
  std::filesystem::remove(folder / "frames/walls_000000.vtp");  // gone all the same: written again
  FrameWriter third(folder.path(), 0.1 * 4);
  state.restore([&](StateVisitor& v) { third.visit(v); });
  third.write(0.5, body_records(scene.world, surfaces), {});
  CHECK(std::filesystem::exists(folder / "frames/walls_000005.vtp"));
}
