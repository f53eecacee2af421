// Bodies from files of other programs: the layouts that LAMMPS, LIGGGHTS and YADE write.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "tests/support/catch.h"

namespace fs = std::filesystem;
using namespace epafi;

namespace {

/// A scene whose bodies come from `text` in a file of this name.
ReadResult read_bodies(const std::string& name, const std::string& text, const std::string& more = "") {
  const fs::path folder = fs::temp_directory_path() / ("epafi-foreign-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / name) << text;
  std::ofstream(folder / "scene.toml")
      << "run = { duration = 1.0 }\ncontact = { method = \"smooth\", restitution = 0.5, friction = 0.1 }\n"
         "material.m = { density = 2500.0, youngs_modulus = 1e6, poissons_ratio = 0.3 }\n"
         "[[bodies]]\nname = \"p\"\nmaterial = \"m\"\nfile = \"" +
             name + "\"\n" + more;
  ReadResult read = read_scene((folder / "scene.toml").string(), {}, full_registry());
  fs::remove_all(folder);
  return read;
}

double radius_of(const Scene& s, std::size_t body) {
  return s.bodies[body].size * s.shapes[s.bodies[body].shape].parameters.number("radius");
}

std::string message(const ReadResult& read) {
  std::string all;
  for (const auto& p : read.problems)
    all += fs::path(p.place.file).filename().string() + ":" + std::to_string(p.place.line) + ": " + p.text + "\n";
  return all;
}

}  // namespace

TEST_CASE("the last frame of a LAMMPS dump becomes bodies", "[scenes][reader][foreign]") {
  const std::string frame = "ITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n0 1\n";
  const auto read = read_bodies("run.dump", "ITEM: TIMESTEP\n0\n" + frame +
                                                "ITEM: ATOMS id type xu yu zu vx vy vz diameter c_ke\n"
                                                "1 1 9 9 9 0 0 0 0.02 0\n2 1 8 8 8 0 0 0 0.04 0\n"
                                                "ITEM: TIMESTEP\n1000\n" +
                                                frame +
                                                "ITEM: ATOMS id type xu yu zu vx vy vz diameter c_ke\n"
                                                "1 1 0.1 0.2 0.3 1 -2 3e-1 0.02 5.5\n2 1 0.4 0.5 0.6 0 0 0 0.04 0\n");
  INFO(message(read));
  REQUIRE(read.scene);
  const Scene& s = *read.scene;
  REQUIRE(s.bodies.size() == 2);
  CHECK(s.bodies[0].position == Vec3(0.1, 0.2, 0.3));
  CHECK(s.bodies[0].velocity == Vec3(1, -2, 0.3));
  CHECK(radius_of(s, 0) == 0.01);
  CHECK(radius_of(s, 1) == 0.02);
  CHECK(body_name(s, 1) == "p[1]");
}

TEST_CASE("a LIGGGHTS dump brings spin, forces are passed over", "[scenes][reader][foreign]") {
  const auto read =
      read_bodies("dump100.liggghts",
                  "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
                  "ITEM: ATOMS id type type x y z ix iy iz vx vy vz fx fy fz omegax omegay omegaz radius \n"
                  "7 1 1 1 2 3 0 0 0 4 5 6 0 0 -1 7 8 9 0.25 \n");
  INFO(message(read));
  REQUIRE(read.scene);
  CHECK(read.scene->bodies[0].angular_velocity == Vec3(7, 8, 9));
  CHECK(radius_of(*read.scene, 0) == 0.25);
}

TEST_CASE("YADE's text export becomes bodies", "[scenes][reader][foreign]") {
  const auto read = read_bodies("packing.txt", "#format x_y_z_r\n0.1\t0.2\t0.3\t0.05\n0.4\t0.5\t0.6\t0.07\n");
  INFO(message(read));
  REQUIRE(read.scene);
  REQUIRE(read.scene->bodies.size() == 2);
  CHECK(read.scene->bodies[1].position == Vec3(0.4, 0.5, 0.6));
  CHECK(radius_of(*read.scene, 1) == 0.07);
}

TEST_CASE("what is missing in a foreign file is said", "[scenes][reader][foreign]") {
  CHECK(message(read_bodies("a.dump", "LAMMPS data file\n")).find("has no line 'ITEM: ATOMS id x y z ...'") !=
        std::string::npos);
  CHECK(message(read_bodies("a.dump", "ITEM: ATOMS id xs ys zs\n1 0 0 0\n"))
            .find("write the dump with x y z in place of xs ys zs") != std::string::npos);
  CHECK(message(read_bodies("a.dump", "ITEM: ATOMS id x y z\n1 0 0 0\n")).find("missing column 'radius' or 'shape'") !=
        std::string::npos);
  CHECK(message(read_bodies("a.dump", "ITEM: ATOMS id x y z radius\n1 0 0 zero 1\n"))
            .find("a.dump:2: column z: expected a number, found 'zero'") != std::string::npos);
  CHECK(message(read_bodies("a.dump", "ITEM: ATOMS id x y z radius\n1 0 0 0\n"))
            .find("a.dump:2: expected 5 columns, found 4") != std::string::npos);
  CHECK(message(read_bodies("a.vtk", "1 2 3\n")).find("expected a table (.csv, .txt,") != std::string::npos);
  // without sizes of its own the file takes the shape that is written
  const auto read =
      read_bodies("a.dump", "ITEM: ATOMS id x y z\n1 0 0 0\n", "shape = { box = { size = [1, 1, 1] } }\n");
  REQUIRE(read.scene);
  CHECK(read.scene->shapes[read.scene->bodies[0].shape].type == "box");
}

TEST_CASE("tables of other programs: names with units, any separator, order and sign", "[scenes][reader][foreign]") {
  const std::vector<std::pair<std::string, std::string>> forms{
      {"a.csv", "x,y,z,radius\n+1.0e-01,-0.2,+0.3,+1e-2\n"},
      {"a.csv", "\xef\xbb\xbfx,y,z,radius\r\n0.1,-0.2,0.3,0.01\r\n"},
      {"a.csv", "Radius[m],PosX[m],PosY[m],PosZ[m]\n0.01,0.1,-0.2,0.3\n"},
      {"a.csv", "Mass[kg],Radius[mm],PosX[cm],PosY[mm],PosZ[m]\n7,10,10,-200,0.3\n"},
      {"a.csv", "x;y;z;r\n0.1;-0.2;0.3;0.01\n"},
      {"a.tsv", "x\ty\tz\tr\n0.1\t-0.2\t0.3\t0.01\n"},
      {"a.txt", "Radius[m] PosX[m] PosY[m] PosZ[m]\n 0.01 0.1 -0.2 0.3\n"},
      {"a.txt", "# x y z r\n0.1 -0.2 0.3 0.01\n"},
      {"a.txt", "#format x_y_z_r\n0.1 -0.2 0.3 0.01\n"},
      {"a.txt", "# x y z r\n0.1 -0.2 0.3\r 0.01\n"},  // columns of two files put side by side
      {"a.txt", std::string("# made by hand\nX Y Z Diameter\n0.1 -0.2 0.3 0.02\n\0\0\0", 53)}};
  for (const auto& [name, text] : forms) {
    const auto read = read_bodies(name, text);
    INFO(text << message(read));
    REQUIRE(read.scene);
    REQUIRE(read.scene->bodies.size() == 1);
    CHECK((read.scene->bodies[0].position - Vec3(0.1, -0.2, 0.3)).norm() < 1e-15);
    CHECK(std::abs(radius_of(*read.scene, 0) - 0.01) < 1e-15);
  }
}

TEST_CASE("columns without names are x y z, or what the scene says", "[scenes][reader][foreign]") {
  const auto three = read_bodies("a.txt", "0.1 -0.2 0.3\n1 2 3\n", "shape = { sphere = { radius = 0.01 } }\n");
  INFO(message(three));
  REQUIRE(three.scene);
  REQUIRE(three.scene->bodies.size() == 2);
  CHECK(three.scene->bodies[1].position == Vec3(1, 2, 3));
  const auto named =
      read_bodies("a.txt", "5 10 -0.2 0.1 0.3\n", "columns = [\"-\", \"radius[mm]\", \"y\", \"x\", \"z\"]\n");
  INFO(message(named));
  REQUIRE(named.scene);
  CHECK(named.scene->bodies[0].position == Vec3(0.1, -0.2, 0.3));
  CHECK(radius_of(*named.scene, 0) == 0.01);
  CHECK(message(read_bodies("a.txt", "1 2 3 4\n")).find("4 columns without names") != std::string::npos);
}

TEST_CASE("a dump is held against the rows and units it names", "[scenes][reader][foreign]") {
  const auto dump = [](const std::string& units, int announced) {
    return (units.empty() ? "" : "ITEM: UNITS\n" + units + "\n") + "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n" +
           std::to_string(announced) +
           "\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\nITEM: ATOMS id x y z vx vy vz radius\n"
           "1 30 20 10 4 0 0 1\n";
  };
  for (const auto& [units, length, speed] : {std::tuple("", 1.0, 1.0), {"cgs", 1e-2, 1e-2}, {"micro", 1e-6, 1.0}}) {
    const auto read = read_bodies("a.dump", dump(units, 1));
    INFO(message(read));
    REQUIRE(read.scene);
    CHECK((read.scene->bodies[0].position - length * Vec3(30, 20, 10)).norm() < 1e-14 * length * 30);
    CHECK(std::abs(read.scene->bodies[0].velocity.x() - 4.0 * speed) < 1e-14 * 4.0 * speed);
    CHECK(std::abs(radius_of(*read.scene, 0) - length) < 1e-15 * length);
  }
  CHECK(message(read_bodies("a.dump", dump("metal", 1))).find("units 'metal'") != std::string::npos);
  CHECK(message(read_bodies("a.dump", dump("", 3))).find("announces 3 bodies and has 1 rows") != std::string::npos);
}

TEST_CASE("a record of motion is read with a byte order mark, plus signs, quotes and blanks",
          "[scenes][reader][foreign]") {
  const auto folder = fs::temp_directory_path() / ("epafi-record-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "base.csv") << "\xef\xbb\xbf\"t\", x \r\n0,+0.0\r\n+0.1,+2e-2\r\n0.2,0\r\n";
  std::ofstream(folder / "scene.toml") << R"(run = { duration = 0.2 }
contact = { method = "smooth", restitution = 0.5, friction = 0.1 }
material.m = { density = 2500.0, youngs_modulus = 1e6, poissons_ratio = 0.3 }
[[body]]
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
motion = { file = "base.csv", of = "displacement" }
)";
  const ReadResult read = read_scene((folder / "scene.toml").string(), {}, full_registry());
  fs::remove_all(folder);
  INFO(message(read));
  CHECK(read.scene.has_value());
}

TEST_CASE("a list of polyhedra that lacks bodies, and a cell that is no number, are told once", "[scenes][reader]") {
  std::string body = "b 4 0 1 1 1 1 0 0 0 1 0 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n", many;
  for (int n = 1; n <= 4; ++n) {
    many += body;
    const auto whole = read_bodies("p.polyset", "polyset 1 7 " + std::to_string(n) + " 1.6\n" + many);
    INFO(message(whole));
    REQUIRE(whole.scene);
    CHECK(whole.scene->bodies.size() == static_cast<std::size_t>(n));
    const auto cut = read_bodies("p.polyset", "polyset 1 7 " + std::to_string(n + 1) + " 1.6\n" + many);
    CHECK_FALSE(cut.scene);
    CHECK(message(cut) == fmt::format("p.polyset:1: the file announces {} bodies and has {}\n", n + 1, n));
  }
  std::string lines = "polyset 1 7 4 1.6\n" + many;
  std::replace(lines.begin(), lines.end(), '\n', '\r');  // one line to us: no body was read of it, and all seemed fine
  CHECK_FALSE(read_bodies("p.polyset", lines).scene);
  const auto bad = read_bodies("b.csv", "x,y,z,radius\n0,0,0,0.1abc\n");
  CHECK(message(bad) == "b.csv:2: column radius: expected a number, found '0.1abc'\n");
}

TEST_CASE("a row of a motion's file with more cells than its header is refused", "[scenes][reader]") {
  // 15.9,5,-296,327 gave x = 5 where -296 was meant, and decimal commas as much
  const fs::path file = fs::temp_directory_path() / fmt::format("epafi-motion-{}.csv", ::getpid());
  const auto errors_with = [&](const std::string& rows) {
    std::ofstream(file) << rows;
    const ReadResult read = read_scene_text(
        "run = { duration = 1.0 }\ncontact = { method = \"smooth\", restitution = 0.5, friction = 0.1 }\n"
        "material.m = { density = 2500.0, youngs_modulus = 1e6, poissons_ratio = 0.3 }\n"
        "[[body]]\nname = \"p\"\nmaterial = \"m\"\nshape = { sphere = { radius = 1 } }\nmotion = { file = \"" +
            file.string() + "\", of = \"displacement\" }\n",
        "scene.toml", {}, full_registry());
    return message(read);
  };
  CHECK(errors_with("t,x,y,z\n0,0,0,0\n1,1,0,0\n") == "");
  CHECK_THAT(errors_with("t,x,y,z\n0,0,0,0\n1,5,1,0,0\n"), Catch::Contains(":3: ") && Catch::Contains("found 5"));
  CHECK_THAT(errors_with("t,x\n0,0\n0,5,1\n"), Catch::Contains("decimal point"));
  fs::remove(file);
}
