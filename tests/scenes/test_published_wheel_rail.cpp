// Figures printed by others for one contact: EN 15302 (tables of its annex), CONTACT 25.2 (its stored outputs), Kalker
// 1990, Carter 1926. Each case is a file of tests/data/wheel_rail/published with its source in the first line;
// tolerances are those of the printed digits and of the reference's own grid.
#include <array>
#include <cmath>
#include <sstream>

#include "scenes/patch/evaluate_patch.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

PatchCase published(const std::string& name) {
  const std::string path = std::string(EPAFI_SOURCE_DIR) + "/tests/data/wheel_rail/published/" + name + ".toml";
  PatchReading r = read_patch(path, {});
  for (const auto& p : r.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(r.patch);
  return std::move(*r.patch);
}

/// The answer of one pair of models; the first of that tangential one where `normal` is empty.
PatchResult answer_of(const std::string& name, const std::string& normal, const std::string& tangential) {
  PatchCase c = published(name);
  if (!normal.empty()) c.normal = {normal};
  c.normal.resize(1);
  c.tangential = tangential.empty() ? std::vector<std::string>{} : std::vector<std::string>{tangential};
  const auto all = evaluate_patch(c);
  REQUIRE(all.size() == 1);
  for (const auto& reason : all.front().reasons) UNSCOPED_INFO(reason);
  return all.front();
}

void check_forces(const std::string& name, const std::string& tangential, double fx, double fy, double within) {
  INFO(name << " " << tangential);
  const double friction = published(name).friction;
  const PatchResult r = answer_of(name, "", tangential);
  const double bound = friction * r.normal_force;
  CHECK(r.force.fx / bound == Approx(fx).margin(within));
  CHECK(r.force.fy / bound == Approx(fy).margin(within));
  CHECK(r.reasons.empty());
}

void check_conicity(const std::string& name, std::initializer_list<std::array<double, 3>> rows) {
  const ProfileCase p = *published(name).profiles;
  for (const auto& [shift, expected, within] : rows) {
    INFO(name << " at " << shift << " m");
    CHECK(equivalent_conicity(p.wheel, p.rail, p.track, shift) == Approx(expected).margin(within));
  }
}

}  // namespace

TEST_CASE("equivalent conicities are those of EN 15302's tables, in flange contact too", "[scenes][wheel_rail]") {
  // annex E with the tolerances of annex F; at 7 mm the flange is at the rail: 0.305 became 0.286 and 0.232 where the
  // shift at the rails was iterated for in place of being given
  check_conicity("en15302_E2", {{1e-3, 0.025, 0.0125},
                                {2e-3, 0.025, 0.0125},
                                {3e-3, 0.058, 0.029},
                                {4e-3, 0.241, 0.05},
                                {5e-3, 0.283, 0.05},
                                {6e-3, 0.302, 0.05},
                                {7e-3, 0.485, 0.05}});
  check_conicity("en15302_E4", {{1e-3, 0.0, 0.01},
                                {2e-3, 0.293, 0.05},
                                {3e-3, 0.489, 0.05},
                                {4e-3, 0.485, 0.05},
                                {5e-3, 0.475, 0.05},
                                {6e-3, 0.447, 0.05}});
}

TEST_CASE("without roll conicities are the table's to 0.002, where the flange meets the rail to its place",
          "[scenes][wheel_rail]") {
  // wheel B on rail A: 0.241 0.283 0.302 at 4, 5, 6 mm; with roll, which the table leaves out, 0.245 0.285 0.304. At 7
  // mm it grows by 0.03 per 0.1 mm and falls by 0.02 per 0.1 mm of gauge
  const ProfileCase p = *published("en15302_E2").profiles;
  const auto conicity = [&](double amplitude, double wider) {
    TrackGeometry track = p.track;
    track.gauge += wider;
    const WheelRailPair side(p.wheel, p.rail, track, true);
    constexpr int n = 120;
    std::vector<double> difference;
    for (int k = -n; k <= n; ++k) {
      WheelsetPosition at;
      at.lateral_shift = amplitude * k / n;
      double radius[2];
      for (const bool right : {false, true}) {
        WheelRailPair wheel = side.on_side(right);
        wheel.place(at);
        wheel.touch();
        radius[right] = wheel.deepest()->rolling_radius;
      }
      difference.push_back(radius[1] - radius[0]);
    }
    return conicity_of(difference, amplitude, track);
  };
  CHECK(conicity(4e-3, 0.0) == Approx(0.241).margin(0.002));
  CHECK(conicity(5e-3, 0.0) == Approx(0.283).margin(0.002));
  CHECK(conicity(6e-3, 0.0) == Approx(0.302).margin(0.002));
  CHECK(conicity(7e-3, 0.0) > 0.485);
  CHECK(conicity(7e-3, 0.1e-3) < 0.485);
}

TEST_CASE("steady rolling has the forces of CONTACT's stored outputs", "[scenes][wheel_rail]") {
  check_forces("steady_xi_circle", "half-space", 0.637, 0.0, 0.006);
  check_forces("eurosprinter_xi_0.002", "half-space", -0.874, 0.0, 0.008);
  check_forces("fastsim_circle_xi_spin", "fastsim", 0.6, -0.2771, 0.03);
  for (const char* law : {"shen-hedrick-elkins", "polach", "coulomb", "fastsim", "fastrip", "half-space"})
    check_forces("yawed_sphere_full_slip", law, 0.01752, -0.9998, 0.003);
  const PatchResult steady = answer_of("steady_xi_circle", "half-space", "half-space");
  CHECK(steady.approach == Approx(7.258e-5).epsilon(0.002));
  CHECK(steady.max_pressure == Approx(18340.0).epsilon(0.002));
  CHECK(answer_of("yawed_sphere_full_slip", "", "coulomb").approach == Approx(3.512e-5).epsilon(0.002));
}

TEST_CASE("shifts have the forces of Cattaneo, starts those of CONTACT cell by cell", "[scenes][wheel_rail]") {
  check_forces("cattaneo_17x17", "half-space-shift", -0.875, 0.0, 0.003);
  check_forces("cattaneo_41x41", "half-space-shift", 0.657, 0.0, 0.003);
  check_forces("cattaneo_kalker_5_25", "half-space-shift", -0.657, 0.0, 0.003);
  check_forces("transient_0.6mm", "half-space-start", -0.04039, -0.04399, 0.0015);
  check_forces("transient_16.2mm", "half-space-start", -0.3802, -0.245, 0.006);
}

TEST_CASE("normal contacts have CONTACT's pressures and approaches", "[scenes][wheel_rail]") {
  for (const char* model : {"hertz", "half-space"}) {
    const PatchResult r = answer_of("hertz_from_approach", model, "");
    CHECK(r.normal_force == Approx(97190.0).epsilon(0.002));
    CHECK(r.max_pressure == Approx(2.901e9).epsilon(0.002));
  }
  for (const char* model : {"hertz", "semi-hertz", "half-space"}) {
    // a ball-shaped tread on an inclined plane, yawed; the plane has no gauge face, its gauge is written
    const PatchResult r = answer_of("inclined_plane_circular_wheel", model, "coulomb");
    CHECK(r.contacts.front().normal_force == Approx(10050.0).epsilon(0.001));
    CHECK(r.max_pressure == Approx(1.365e9).epsilon(std::string(model) == "half-space" ? 0.006 : 0.02));
    CHECK(r.contacts.front().point.y() == Approx(0.7594953).margin(1e-5));
  }
  const PatchResult groove = answer_of("groove_r10.25", "half-space", "coulomb");
  CHECK(groove.max_pressure == Approx(5.302e8).epsilon(0.02));
  CHECK(groove.approach == Approx(2.237e-5).epsilon(0.003));
}

TEST_CASE("a line contact rolls as Carter says, by strips and by half-spaces", "[scenes][wheel_rail]") {
  for (const char* law : {"strip", "half-space"}) check_forces("carter_0.2_R625", law, 0.2, 0.0, 0.001);
  // Q = mu N (1 - (1 - xi/xi_s)^2) with xi_s = mu a / R, R the combined radius (Johnson 1985, section 8.3)
  for (const double length : {0.01, 1.0, 10.0}) {
    PatchCase c = published("carter_0.2_R625");
    c.length = length;
    c.target.value = 1.5e6 * length;
    c.tangential = {"half-space"};
    for (const double share : {0.01, 0.3, 0.9, 1.5}) {
      const double a = std::sqrt(4.0 * 1.5e6 * c.radii->x1 / (M_PI * c.elastic.effective_modulus()));
      c.creepage.longitudinal = -share * c.friction * a / c.radii->x1;
      const PatchResult r = evaluate_patch(c).front();
      const double exact = share < 1.0 ? 1.0 - (1.0 - share) * (1.0 - share) : 1.0;
      CHECK(r.force.fx / (c.friction * c.target.value) == Approx(exact).margin(r.error_estimate + 1e-9));
      CHECK(r.reasons.empty());
    }
  }
}

TEST_CASE("at vanishing creepage half-spaces have Kalker's linear force, whatever its size", "[scenes][wheel_rail]") {
  // c11 of Kalker's table for a/b = 0.1 is 3.31 (nu = 0.25): F = -G a b c11 xi. The solver's tolerance was a share of
  // mu N, of which this force is 1e-5: 18 % of it were missing
  PatchCase c = published("eurosprinter_xi_0.002");
  c.ellipse = Ellipse{2e-3, 20e-3};
  c.tangential = {"kalker-linear", "half-space"};
  c.dx = c.ellipse->a / 8.0;  // 16 cells along
  c.dy = c.ellipse->b / 16.0;
  for (const double xi : {1e-7, 1e-5}) {
    c.creepage.longitudinal = xi;
    const auto all = evaluate_patch(c);
    const double bound = c.friction * c.target.value, off = std::abs(all[1].force.fx - all[0].force.fx);
    CHECK(off < 0.02 * std::abs(all[0].force.fx));
    CHECK(all[1].error_estimate < 0.05 * std::abs(all[0].force.fx) / bound);
  }
}

TEST_CASE("unlike materials and lines along the track are no cases of Carter's", "[scenes][wheel_rail]") {
  const std::string head =
      "[material.al]\nshear_modulus = 23e9\npoissons_ratio = 0.31\n[material.st]\nshear_modulus = 82e9\n"
      "poissons_ratio = 0.28\n[contact]\nfriction = 0.05\n[patch]\nlength = 1\nload = 16201.9\n"
      "creepage = { longitudinal = 2.108e-4 }\ntangential = [\"strip\", \"half-space\", \"half-space-shift\"]\n"
      "grid = { dx = \"0.1 mm\", dy = 0.1 }\n";
  const auto reasons = [&](const std::string& more) {
    const PatchReading r = read_patch_text(head + more, "case.toml", {});
    REQUIRE(r.patch);
    std::vector<std::size_t> out;
    for (const PatchResult& p : evaluate_patch(*r.patch)) out.push_back(p.reasons.size());
    return out;
  };
  // Bentall and Johnson 1967: 0.75 mu N there, where like materials would slide
  for (const std::size_t n :
       reasons("radii = { x1 = 0.05, x2 = 0.05, y1 = inf, y2 = inf }\nmaterials = [\"al\", \"st\"]\n"))
    CHECK(n > 0);
  for (const std::size_t n :
       reasons("radii = { x1 = inf, x2 = inf, y1 = 0.05, y2 = inf }\nmaterials = [\"st\", \"st\"]\n"))
    CHECK(n > 0);
  const auto good = reasons("radii = { x1 = 0.05, x2 = 0.05, y1 = inf, y2 = inf }\nmaterials = [\"st\", \"st\"]\n");
  CHECK(good[0] == 0);
  CHECK(good[1] == 0);
  CHECK(good[2] > 0);
}

TEST_CASE("columns of the table stay apart whatever the size of forces", "[scenes][wheel_rail]") {
  PatchCase c = published("cattaneo_41x41");
  c.target.value = 1.2345e-9;
  c.creepage = {-1.2345e-7, 3.4567e-8, 0.0};
  c.tangential = {"kalker-linear", "shen-hedrick-elkins"};
  const std::string table = patch_table(evaluate_patch(c));
  std::istringstream lines(table);
  std::string line, word;
  std::getline(lines, line);
  for (int k = 0; k < 2; ++k) {
    std::getline(lines, line);
    std::istringstream words(line);
    int count = 0;
    while (words >> word) ++count;
    CHECK(count == 12);  // two names, eight numbers, stick or a dash, valid
    while (lines.peek() == ' ') std::getline(lines, line);
  }
}

TEST_CASE("a text that looks like a number is a text where one is expected after --set", "[scenes][reader]") {
  const std::string text =
      "[material.m]\nshear_modulus = 82e9\npoissons_ratio = 0.28\n[contact]\nfriction = 0.3\n[shape.w]\n"
      "wheel_profile = { name = \"s1002\" }\n[shape.r]\nrail_profile = { name = \"uic60\" }\n[patch]\nload = 6e4\n";
  const PatchReading r = read_patch_text(text, "case.toml", {"shape.r.rail_profile.name=60e1"});
  REQUIRE(r.patch);
  CHECK(r.patch->profiles->rail.at(0.02).z ==
        Approx(Profile(canted_rail(*built_in_profile("60e1"), 0.0)).at(0.02).z).margin(1e-12));
  CHECK_FALSE(read_patch_text(text, "case.toml", {"patch.load=\"60e1 mm\""}).patch);
  CHECK_FALSE(read_patch_text(text + "side = 60e1\n", "case.toml", {}).patch);
}
