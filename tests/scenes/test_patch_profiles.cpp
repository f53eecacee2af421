// Wheel and rail by profiles: several regions of contact, profiles that are no wheel or rail as they are counted here,
// and every place a wheelset may be put.
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "scenes/patch/evaluate_patch.h"
#include "scenes/railway/plausible.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

const std::string steel =
    "[material.steel]\nshear_modulus = \"82 GPa\"\npoissons_ratio = 0.28\n[contact]\nfriction = 0.3\n";

std::string built_in(const std::string& rail, double cant, double radius = 0.46) {
  return fmt::format(
      "[shape.wheel]\nwheel_profile = {{ name = \"s1002\", radius = {} }}\n[shape.rail]\nrail_profile = {{ name = "
      "\"{}\", cant = {:.17g} }}\n",
      radius, rail, cant);
}

PatchReading reading_of(const std::string& shapes, const std::string& patch) {
  return read_patch_text(steel + shapes + "[patch]\n" + patch, "case.toml", {});
}

std::vector<PatchResult> answers(const std::string& shapes, const std::string& patch) {
  const PatchReading r = reading_of(shapes, patch);
  for (const auto& p : r.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(r.patch);
  return evaluate_patch(*r.patch);
}

std::string all_problems(const PatchReading& r) {
  std::string all;
  for (const auto& p : r.problems) all += p.to_string() + "\n";
  return all;
}

/// A file of points in a folder of its own, gone with this.
class PointsFile {
 public:
  explicit PointsFile(const ProfilePoints& p, const std::string& unit = "m", bool numbered = false) {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() / fmt::format("epafi_profile_{}_{}.csv", getpid(), ++count);
    std::ofstream out(path_);
    out << "# unit: " << unit << "\n";
    for (std::size_t k = 0; k < p.y.size(); ++k)
      out << (numbered ? fmt::format("{},", k + 1) : "") << fmt::format("{:.12g},{:.12g}\n", p.y[k], p.z[k]);
  }
  ~PointsFile() { std::filesystem::remove(path_); }
  PointsFile(const PointsFile&) = delete;
  PointsFile& operator=(const PointsFile&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// Points between two y, each through y -> a y + b and z -> c z.
ProfilePoints changed(const ProfilePoints& p, double a, double b, double c, double from = -1.0, double to = 1.0) {
  ProfilePoints out;
  for (std::size_t k = 0; k < p.y.size(); ++k) {
    if (p.y[k] < from || p.y[k] > to) continue;
    out.y.push_back(a * p.y[k] + b);
    out.z.push_back(c * p.z[k]);
  }
  if (a < 0.0) {
    std::reverse(out.y.begin(), out.y.end());
    std::reverse(out.z.begin(), out.z.end());
  }
  return out;
}

std::string wheel_and_rail(const std::string& wheel, const std::string& rail) {
  const auto keys = [](const std::string& what, const std::string& name) {
    return (what.find('/') == std::string::npos ? "name = \"" : "file = \"") + what + "\"" + name;
  };
  return "[shape.wheel]\nwheel_profile = { " + keys(wheel, ", radius = 0.46") + " }\n[shape.rail]\nrail_profile = { " +
         keys(rail, "") + " }\n";
}

}  // namespace

TEST_CASE("tread and gauge corner 29 mm apart share the load as CONTACT has it", "[scenes][wheel_rail][long]") {
  // CONTACT 25.2, 0.25 mm cells: at 754.2 mm 48230 N, 913 MPa, approach 44.2 um; at 725.4 mm 11810 N, 1402 MPa; creep
  // forces -4384 and -2412 N
  const std::string shapes = built_in("uic60", 0.05),
                    place = "load = \"60 kN\"\nlateral_shift = \"6 mm\"\nroll = 0\nrolling_radius = 0.46\n";
  for (const PatchResult& r :
       answers(shapes, place + "normal = [\"hertz\", \"kik-piotrowski\", \"stripes\", \"analyn\"]\n")) {
    INFO(r.normal);
    CHECK(std::any_of(r.reasons.begin(), r.reasons.end(),
                      [](const std::string& text) { return text.find("second region") != std::string::npos; }));
  }
  for (const PatchResult& r :
       answers(shapes, place + "normal = [\"semi-hertz\", \"half-space\"]\ntangential = \"half-space\"\n")) {
    INFO(r.normal);
    REQUIRE(r.contacts.size() == 2);
    const bool first = r.contacts[0].point.y() > 0.74;
    const PatchContact &tread = r.contacts[first ? 0 : 1], &corner = r.contacts[first ? 1 : 0];
    CHECK(tread.point.y() == Approx(0.7542).margin(0.3e-3));
    CHECK(corner.point.y() == Approx(0.7254).margin(0.1e-3));
    // the corner is 7 of the reference's cells wide, which is 3 to 4 % of its peak
    CHECK(tread.normal_force == Approx(48230).epsilon(0.02));
    CHECK(corner.normal_force == Approx(11810).epsilon(0.02));
    CHECK(tread.max_pressure == Approx(913e6).epsilon(0.015));
    CHECK(corner.max_pressure == Approx(1402e6).epsilon(0.04));
    CHECK(r.approach == Approx(44.2e-6).epsilon(0.015));
    CHECK(std::hypot(r.force.fx + 4384, r.force.fy + 2412) < 0.045 * 0.3 * 60e3);
    CHECK(r.reasons.empty());
  }
}

TEST_CASE("the load of regions apart is met and changes steadily as one of them opens", "[scenes][wheel_rail]") {
  double last = 0.0;
  for (double shift = 5.6; shift <= 6.05; shift += 0.05) {
    INFO(shift);
    const PatchResult r =
        answers(built_in("60e1", std::atan(0.05)),
                fmt::format("load = 60e3\nlateral_shift = {}\nnormal = \"semi-hertz\"\n", 1e-3 * shift))
            .front();
    double vertical = 0.0;
    for (const PatchContact& c : r.contacts) vertical += c.normal_force * std::cos(c.angle);
    CHECK(vertical == Approx(60e3).epsilon(1e-3));
    // the tread's share: no jump by more than a fifth of the load in 0.05 mm
    double tread = 0.0;
    for (const PatchContact& c : r.contacts)
      if (c.y_rail < 15e-3) tread += c.normal_force;
    if (shift > 5.6) CHECK(std::abs(tread - last) < 12e3);
    last = tread;
  }
}

TEST_CASE("the rolling radius of a wheelset that is not told changes steadily with its place", "[scenes][wheel_rail]") {
  // the rigid contact jumps by 10 mm between 0.2 and 0.25 mm, and its rolling radius by 0.3 mm: 0.6e-3 of creepage
  double last = 0.0;
  for (double shift = 0.0; shift <= 0.6; shift += 0.05) {
    const PatchResult r =
        answers(built_in("uic60", std::atan(1.0 / 40)),
                fmt::format("load = 60e3\nlateral_shift = {}\nnormal = \"semi-hertz\"\ntangential = \"fastsim\"\n",
                            1e-3 * shift))
            .front();
    INFO(shift << " mm: " << r.force.fx);
    if (shift > 0.0) CHECK(std::abs(r.force.fx - last) < 0.12 * 0.3 * 60e3);
    last = r.force.fx;
  }
}

TEST_CASE("profiles that are counted otherwise are refused, and the message says how", "[scenes][wheel_rail]") {
  const ProfilePoints wheel = *built_in_profile("s1002"), rail = *built_in_profile("uic60");
  struct Wrong {
    bool is_wheel;
    ProfilePoints points;
    std::string unit, says;
    bool numbered = false;
  };
  const double one = 1.0;
  const std::vector<Wrong> wrong{
      {true, changed(wheel, -one, 0.0, one), "m", "lies on the field side"},
      {true, changed(wheel, -one, 0.0, one, -0.06, 0.06), "m", "lies on the field side"},
      {true, changed(wheel, one, 0.0, -one), "m", "change the sign of z"},
      {true, changed(wheel, -one, 0.0, -one), "m", "change the sign of z and of y"},
      {true, changed(wheel, one, 0.07, one), "m", "from the flange's back"},
      {true, changed(wheel, 1e3, 0.0, 1e3), "m", "unit"},
      {true, wheel, "mm", "unit"},
      {true, changed(wheel, 1e3, 0.0, 1e3), "mm", "numbers the points", true},
      {false, changed(rail, one, 0.0, -one), "m", "change the sign of z"},
      {false, changed(rail, 1e3, 0.0, 1e3), "m", "unit"},
      {false, rail, "mm", "unit"},
      {false, changed(rail, one, 0.05, one), "m", "from the rail's axis"},
      {false, changed(rail, one, 0.0, one, -0.02, 0.02), "m", "give the whole head"},
  };
  for (const Wrong& w : wrong) {
    INFO(w.says);
    const PointsFile file(w.points, w.unit, w.numbered);
    const PatchReading r = reading_of(
        w.is_wheel ? wheel_and_rail(file.path(), "uic60") : wheel_and_rail("s1002", file.path()), "load = 60e3\n");
    CHECK_FALSE(r.patch);
    CHECK_THAT(all_problems(r), Catch::Contains(w.says));
  }
}

TEST_CASE("a rail with its sides exchanged is used, and nothing of it is valid", "[scenes][wheel_rail]") {
  const ProfilePoints inclined = canted_rail(*built_in_profile("uic60"), 1.0 / 40);
  const PointsFile right(inclined), mirrored(changed(inclined, -1.0, 0.0, 1.0));
  const std::string patch = "load = 60e3\nlateral_shift = 2e-3\nnormal = \"half-space\"\n";
  CHECK(answers(wheel_and_rail("s1002", right.path()), patch).front().reasons.empty());
  const auto all = answers(wheel_and_rail("s1002", mirrored.path()), patch);
  REQUIRE_FALSE(all.front().reasons.empty());
  CHECK_THAT(all.front().reasons.back(), Catch::Contains("sides exchanged"));
}

TEST_CASE("every place of a wheelset has a contact or a reason", "[scenes][wheel_rail]") {
  // cant, gauge, radius, shift, yaw and roll at random, on both sides; the load is met wherever the answer is valid
  std::mt19937 random(7);
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  int touching = 0;
  for (int n = 0; n < 150; ++n) {
    const std::string shapes =
        built_in(n % 2 ? "60e1" : "uic60", n % 5 ? in(0.0, 0.06) : in(-0.5, 0.5), n % 3 ? 0.46 : in(0.2, 0.7));
    const double wide = n % 7 ? 0.01 : 0.2;
    const std::string patch = fmt::format(
        "load = 60e3\nlateral_shift = {}\nyaw = {}\ngauge = {}\nside = \"{}\"\nnormal = [\"hertz\", "
        "\"semi-hertz\"]\n{}",
        in(-wide, wide), in(-0.05, 0.05), n % 4 ? 1.435 : in(1.40, 1.47), n % 2 ? "right" : "left",
        n % 6 ? "" : fmt::format("roll = {}\n", in(-0.02, 0.02)));
    INFO(shapes << patch);
    for (const PatchResult& r : answers(shapes, patch)) {
      const bool touches = r.normal_force > 0.0;
      touching += touches;
      if (!touches) CHECK_FALSE(r.reasons.empty());
      if (!r.reasons.empty()) continue;
      double vertical = 0.0;
      for (const PatchContact& c : r.contacts) vertical += c.normal_force * std::cos(c.angle);
      CHECK(vertical == Approx(60e3).epsilon(2e-3));
    }
  }
  CHECK(touching > 150);
}

TEST_CASE("a flank that the cant sets upright or lets overhang is left out", "[scenes][wheel_rail]") {
  // 60E1 and UIC60 have flanks of 1:20: at a cant of atan(1/20) the spline had two points over each other
  for (const double cant : {std::atan(0.05), 0.05, 0.0499, 0.06, -0.05, 0.3, -0.3, 0.5}) {
    const ProfilePoints p = canted_rail(*built_in_profile("uic60"), cant);
    for (std::size_t k = 1; k < p.y.size(); ++k) {
      CHECK(p.y[k] > p.y[k - 1]);
      CHECK(std::isfinite(p.z[k]));
    }
  }
  const auto at = [](double cant) {
    return answers(built_in("uic60", cant), "load = 60e3\nlateral_shift = 2e-3\nnormal = \"half-space\"\n").front();
  };
  const double exact = at(std::atan(0.05)).max_pressure;
  for (const double cant : {0.0499, 0.05}) CHECK(at(cant).max_pressure == Approx(exact).epsilon(0.002));
}

TEST_CASE("one point off a profile, too much smoothing and inches for millimetres are told, sound profiles are not",
          "[scenes][wheel_rail]") {
  const ProfilePoints wheel = *built_in_profile("s1002"), rail = *built_in_profile("uic60");
  std::mt19937 random(3);
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const auto doubts_of = [&](const ProfilePoints& p, const std::string& more) {
    const PointsFile file(p);
    const PatchReading r = reading_of("[shape.wheel]\nwheel_profile = { file = \"" + file.path() + "\"" + more +
                                          " }\n[shape.rail]\nrail_profile = { name = \"uic60\", cant = 0.025 }\n",
                                      "load = 60e3\nlateral_shift = 3e-3\n");
    REQUIRE(r.patch);
    std::string all;
    for (const std::string& text : r.patch->profiles->doubts) all += text + "\n";
    return all;
  };
  CHECK(doubts_of(wheel, "") == "");
  for (int n = 0; n < 20; ++n) {
    ProfilePoints one = wheel;
    const double place = in(-0.03, 0.05);  // tread and fillet
    const auto k = static_cast<std::size_t>(std::lower_bound(wheel.y.begin(), wheel.y.end(), place) - wheel.y.begin());
    const double step = 0.5 * (wheel.y[k + 1] - wheel.y[k - 1]);
    one.z[k] += (n % 2 ? 1.0 : -1.0) * in(500.0, 5000.0) * step * step;
    INFO(wheel.y[k] << " " << one.z[k] - wheel.z[k] << " " << step);
    CHECK_THAT(outlier_remark(one), Catch::Contains(fmt::format("the point at y = {:.6g} m", wheel.y[k])));
  }
  for (const ProfilePoints& sound : {wheel, rail, canted_rail(rail, 0.025), *built_in_profile("60e1")})
    CHECK(outlier_remark(sound) + hole_remark(sound) == "");
  CHECK_THAT(doubts_of(wheel, ", smoothing = \"1 mm\""), Catch::Contains("the curve leaves the profile"));
  CHECK_THAT(doubts_of(changed(wheel, 1 / 25.4, 0.0, 1 / 25.4), ""), Catch::Contains("is the unit"));
  const PointsFile radii([&] {
    ProfilePoints p = wheel;
    for (double& z : p.z) z += 0.46;
    return p;
  }());
  const PatchReading r = reading_of(wheel_and_rail(radii.path(), "uic60"), "load = 60e3\n");
  CHECK_FALSE(r.patch);
  CHECK_THAT(all_problems(r), Catch::Contains("subtract 0.46 m"));
}

TEST_CASE("points that are missing within a profile are told with place and width", "[scenes][wheel_rail]") {
  std::mt19937 random(7);
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const std::vector<ProfilePoints> profiles{*built_in_profile("s1002"), *built_in_profile("uic60")};
  for (int draw = 0; draw < 60; ++draw) {
    const Profile curve(profiles[draw % 2]);
    const double step = in(0.3e-3, 1.2e-3), from = in(-0.025, 0.0), width = in(6.5, 25.0) * step;
    ProfilePoints dense, holed;
    for (double y = -0.03; y < 0.03; y += in(0.7, 1.3) * step) {
      for (ProfilePoints* p : {&dense, &holed}) {
        if (p == &holed && y > from && y < from + width) continue;
        p->y.push_back(y);
        p->z.push_back(curve.at(y).z);
      }
    }
    const auto after = std::upper_bound(holed.y.begin(), holed.y.end(), from);
    INFO("step " << step << " hole " << from << " to " << from + width);
    CHECK(hole_remark(dense) == "");
    CHECK_THAT(hole_remark(holed),
               Catch::Contains(fmt::format("no points from y = {:.6g} to {:.6g} m", after[-1], *after)));
  }
}
