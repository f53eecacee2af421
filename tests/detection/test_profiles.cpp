// Profiles and the rigid contact of wheel and rail against published definitions, independent tables and geometry.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "detection/profiles/wheel_rail.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

const double cant = std::atan(1.0 / 40.0);

ProfilePoints profile_table(const std::string& name) {
  std::ifstream in(std::string(EPAFI_SOURCE_DIR) + "/tests/data/wheel_rail/" + name);
  std::stringstream text;
  text << in.rdbuf();
  const ProfileFile file = read_profile(text.str());
  INFO(file.problem);
  REQUIRE(file.problem.empty());
  return file.points;
}

const Profile& s1002() {
  static const Profile p(*built_in_profile("s1002"));
  return p;
}
const Profile& uic60() {
  static const Profile p(canted_rail(*built_in_profile("uic60"), cant));
  return p;
}

}  // namespace

TEST_CASE("built-in profiles agree with independent tables to a micrometre", "[detection][wheel_rail]") {
  const auto worst = [](const Profile& profile, const ProfilePoints& points, double deepest) {
    double w = 0.0;
    for (std::size_t k = 0; k < points.y.size(); ++k)
      if (points.z[k] < deepest) w = std::max(w, std::abs(profile.at(points.y[k]).z - points.z[k]));
    return w;
  };
  CHECK(worst(s1002(), profile_table("wheel_s1002.csv"), 1.0) <
        2e-7);  // 1.2e-4 mm steps at the joints of the definition
  CHECK(worst(uic60(), profile_table("rail_uic60_1in40.csv"), 0.013) < 1e-6);
  CHECK(worst(Profile(*built_in_profile("60e1")), profile_table("rail_60e1.csv"), 0.013) < 1e-6);
  CHECK(built_in_profile("s1003") == nullptr);
}

TEST_CASE("a spline through a cubic has its slope and curvature; a smoothed one keeps its distance",
          "[detection][wheel_rail]") {
  ProfilePoints p, noisy;
  for (int k = 0; k <= 200; ++k) {
    const double y = 1e-3 * (k - 100), z = 3.0 * y * y * y - y * y;
    p.y.push_back(y);
    p.z.push_back(z);
    noisy.y.push_back(y);
    noisy.z.push_back(z + 1e-6 * std::sin(37.0 * k * k));
  }
  const Profile through(p), rough(noisy), smooth(noisy, 0.7e-6);
  // the natural end, where the second derivative is made 0, fades over a few points
  for (const double y : {-0.05, 0.0123, 0.04}) {
    CHECK(through.at(y).z == Approx(3.0 * y * y * y - y * y).margin(1e-12));
    CHECK(through.at(y).slope == Approx(9.0 * y * y - 2.0 * y).margin(1e-8));
    CHECK(through.at(y).second == Approx(18.0 * y - 2.0).margin(1e-5));
  }
  // noise of a micrometre on points a millimetre apart bends the spline by 4 /m; smoothing takes most of that away
  double bent = 0.0, bent_smooth = 0.0;
  for (double y = -0.08; y < 0.08; y += 0.5e-3) {
    bent += std::pow(rough.at(y).second - (18.0 * y - 2.0), 2);
    bent_smooth += std::pow(smooth.at(y).second - (18.0 * y - 2.0), 2);
  }
  CHECK(bent_smooth < 0.1 * bent);
  double rms = 0.0;
  for (std::size_t k = 0; k < noisy.y.size(); ++k) rms += std::pow(smooth.z_of_point(k) - noisy.z[k], 2);
  CHECK(std::sqrt(rms / static_cast<double>(noisy.y.size())) == Approx(0.7e-6).epsilon(1e-3));
}

TEST_CASE("what is wrong with a profile file is named with its line", "[detection][wheel_rail]") {
  CHECK(read_profile("# unit: mm\ny,z\n0,0\n1,0\n2,0\n3,0.5\n").points.z[3] == Approx(0.5e-3));
  CHECK(read_profile("# unit: m\n3 0\n2 0\n1 0\n0 1\n").points.y[0] == 0.0);  // either direction
  CHECK(read_profile("0,0\n1,0\n").problem.find("state the unit") != std::string::npos);
  CHECK(read_profile("# unit: kg\n0,0\n").problem.find("unit 'kg'") != std::string::npos);
  const ProfileFile bad = read_profile("# unit: mm\n0,0\n1,x\n");
  CHECK(bad.line == 3);
  CHECK(bad.problem.find("expected two numbers") != std::string::npos);
  CHECK(read_profile("# unit: mm\n0,0\n1,0\n0.5,0\n2,1\n").problem.find("undercut") != std::string::npos);
  CHECK(read_profile("# unit: mm\n0,0\n1,0\n").problem.find("at least 4 points") != std::string::npos);
}

TEST_CASE("a profile file is read as it was meant, or the line that could be meant otherwise is named",
          "[detection][wheel_rail]") {
  const auto says = [](const std::string& text, const std::string& expected, int line) {
    const ProfileFile file = read_profile(text);
    INFO(text << "\n" << file.problem);
    CHECK(file.problem.find(expected) != std::string::npos);
    CHECK(file.line == line);
    CHECK(file.problem.size() < 200);
  };
  Random random(12, 0);
  const auto rows = [&](const std::string& between, char point, const std::string& end) {
    std::string text;
    for (int k = -20; k <= 20; ++k) {
      std::string row =
          std::to_string(k + random.uniform(0.0, 0.5)) + between + std::to_string(random.uniform(0.0, 9.0));
      std::replace(row.begin(), row.end(), '.', point);
      text += row + end;
    }
    return text;
  };
  for (const char* between : {";", "; ", "\t", " "}) {
    says("# unit: mm\n" + rows(between, ',', "\n"), "decimal commas", 2);
    says("# unit: mm\n-20;0\n-19,5;1\n", "decimal commas", 3);
    for (const char* end : {"\n", "\r\n", "\r", " \n"}) {
      const std::string text = "# unit: mm" + std::string(end) + rows(between, '.', end);
      for (const char* before : {"", "\xef\xbb\xbf", "  "}) {
        const ProfileFile file = read_profile(before + text);
        INFO(before << text << file.problem);
        CHECK(file.problem.empty());
        CHECK(file.points.y.size() == 41);
      }
    }
  }
  const std::string more = "1,0\n2,0\n3,0\n4,0\n";
  says("# unit: mm\n-70,abc\n" + more, "expected two numbers", 2);  // was taken for names of columns
  says("# unit: mm\n0.0mm,1\n" + more, "expected two numbers", 2);
  says("# unit: mm\n0,0\n" + more + "5,1.5.3\n", "expected two numbers", 7);
  says("# unit: mm\n# unit: m\n0,0\n" + more, "a second unit", 2);
  CHECK(read_profile("# unit: mm\ny [mm];z [mm]\n0;0;0.1;inf\n" + more).problem.empty());
}

TEST_CASE("where y turns back in a profile file the first such line is named, in either direction",
          "[detection][wheel_rail]") {
  Random random(31, 0);
  for (int draw = 0; draw < 200; ++draw) {
    const int points = 5 + static_cast<int>(random.bits() % 60),
              back = 2 + static_cast<int>(random.bits() % (points - 3));
    const double way = draw % 2 == 0 ? 1.0 : -1.0;
    std::string text = "# unit: mm\n";
    int line = 1, expected = 0;
    for (int k = 0; k < points; ++k) {
      for (; random.bits() % 5 == 0; ++line) text += "# a remark\n";
      // this point lies before the one in front of it
      const double y = way * (k == back ? k - random.uniform(1.1, 1.9) : k);
      text += std::to_string(y) + "," + std::to_string(0.01 * k * k) + "\n";
      ++line;
      if (k == back) expected = line;
    }
    const ProfileFile file = read_profile(text);
    INFO("draw " << draw << "\n" << text);
    CHECK(file.line == expected);
    CHECK(file.problem.find("y turns back here (1 of") == 0);
  }
}

TEST_CASE("the contact jumps on S1002 and UIC60 where it should, without chatter", "[detection][wheel_rail]") {
  // rigid geometry, no yaw: on the right rail from 0.6 to 10.9 mm between 0.20 and 0.25 mm of shift
  const TrackGeometry track;
  double last = 0.0;
  int jumps = 0;
  for (double y = 0.0; y <= 4e-3; y += 0.02e-3) {
    WheelsetPosition p;
    p.lateral_shift = y;
    const WheelsetGeometry g = stand_on_rails(s1002(), uic60(), track, p);
    if (y > 0.0 && std::abs(g.right.y_rail - last) > 2e-3) {
      ++jumps;
      CHECK(y > 0.20e-3);
      CHECK(y < 0.26e-3);
    }
    last = g.right.y_rail;
  }
  CHECK(jumps == 1);
  // near the jump both places are reported
  WheelRailPair right(s1002(), uic60(), track, true);
  WheelsetPosition p;
  p.lateral_shift = 0.22e-3;
  right.place(p);
  right.touch();
  const auto regions = right.find_regions(1e-5);
  REQUIRE(regions.size() == 2);
  CHECK(std::abs(regions[0].y_rail - regions[1].y_rail) > 9e-3);
  CHECK(regions[1].offset < 1e-5);
}

TEST_CASE("a centred wheelset is symmetric, a shifted one mirrors", "[detection][wheel_rail]") {
  const TrackGeometry track;
  const WheelsetGeometry centred = stand_on_rails(s1002(), uic60(), track, {});
  CHECK(centred.rolling_radius_difference() == Approx(0.0).margin(1e-9));
  CHECK(centred.right.y_wheel == Approx(3.25e-3).margin(0.01e-3));  // 3.252 mm by an independent calculation
  WheelsetPosition a, b;
  a.lateral_shift = 2e-3;
  a.yaw = 0.005;
  b.lateral_shift = -2e-3;
  b.yaw = -0.005;
  const WheelsetGeometry ga = stand_on_rails(s1002(), uic60(), track, a),
                         gb = stand_on_rails(s1002(), uic60(), track, b);
  CHECK(ga.right.point.y() == Approx(-gb.left.point.y()).epsilon(1e-9));
  CHECK(ga.right.point.x() == Approx(gb.left.point.x()).epsilon(1e-6));
  CHECK(ga.right.angle == Approx(-gb.left.angle).epsilon(1e-9));
}

TEST_CASE("the gap around a contact is that of its curvatures and grows from it", "[detection][wheel_rail]") {
  const TrackGeometry track;
  WheelRailPair right(s1002(), uic60(), track, true);
  for (const double y : {1e-3, 3e-3, 7e-3}) {
    WheelsetPosition p;
    p.lateral_shift = y;
    p.yaw = 2.4 * y;
    p.roll = stand_on_rails(s1002(), uic60(), track, p).position.roll;
    right.place(p);
    right.touch();
    const ContactRegion r = right.find_regions(1e-4).front();
    const GapField f = right.field(r, 0.0, 0.0, 0.2e-3, 0.05e-3, 41, 41);
    for (const double h : f.gap) CHECK(h >= -1e-9);
    CHECK(f.at(20, 20) == Approx(0.0).margin(2e-9));
    const double kx = (f.at(30, 20) + f.at(10, 20) - 2.0 * f.at(20, 20)) / (2e-3 * 2e-3);
    // on the flange yaw twists the principal directions out of x and y
    CHECK(kx == Approx(r.curvature_x).epsilon(y > 6e-3 ? 0.07 : 0.03));
    const double ky = (f.at(20, 24) + f.at(20, 16) - 2.0 * f.at(20, 20)) / (0.2e-3 * 0.2e-3);
    CHECK(ky == Approx(r.curvature_y).epsilon(0.1));
  }
}

TEST_CASE("cones on sharp rails have the conicity of the cone", "[detection][wheel_rail]") {
  ProfilePoints cone, rail;
  for (int k = -60; k <= 60; ++k) {
    cone.y.push_back(1e-3 * k);
    cone.z.push_back(-0.05 * 1e-3 * k);
  }
  for (int k = -300; k <= 300; ++k) {
    const double y = 1e-4 * k, R = 0.05;  // round head of 50 mm, down to 14 mm and beyond
    rail.y.push_back(y);
    rail.z.push_back(R - std::sqrt(R * R - y * y) + (std::abs(y) > 0.029 ? 20.0 * (std::abs(y) - 0.029) : 0.0));
  }
  CHECK(equivalent_conicity(Profile(cone), Profile(rail), TrackGeometry{}, 3e-3) == Approx(0.05).epsilon(5e-3));
}

TEST_CASE("the equivalent conicity of S1002 on UIC60 is the published one", "[detection][wheel_rail][slow]") {
  const double published[] = {0.368, 0.227, 0.181, 0.162,
                              0.156};  // at 1 ... 5 mm, EN 15302's method, by an independent calculation
  for (int k = 0; k < 5; ++k)
    CHECK(equivalent_conicity(s1002(), uic60(), TrackGeometry{}, 1e-3 * (k + 1)) == Approx(published[k]).epsilon(0.02));
}
