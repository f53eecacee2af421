// The Manchester benchmark A-2.2 (S1002 on UIC60, yawed wheelset) against boundary elements of CONTACT 25.2 on 0.2 mm
// cells, and the laws' flags where they leave their range there (tests/data/wheel_rail/manchester_a22.csv).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "laws/wheel_rail/normal_models.h"
#include "scenes/patch/evaluate_patch.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

struct Row {
  std::string side;
  double shift, yaw, roll, pitch_rate, N, fx, fs, approach, p0, xi, eta, phi, x, y, angle, cells;
};

std::vector<Row> rows() {
  std::ifstream in(std::string(EPAFI_SOURCE_DIR) + "/tests/data/wheel_rail/manchester_a22.csv");
  std::vector<Row> out;
  std::string line;
  for (int skip = 0; skip < 2; ++skip) std::getline(in, line);
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream s(line);
    Row r;
    s >> r.side >> r.shift >> r.yaw >> r.roll >> r.pitch_rate >> r.N >> r.fx >> r.fs >> r.approach >> r.p0 >> r.xi >>
        r.eta >> r.phi >> r.x >> r.y >> r.angle >> r.cells;
    out.push_back(r);
  }
  return out;
}

PatchResult evaluate(const Row& r, const std::string& normal, const std::string& tangential,
                     const std::string& more = "", double cell = 2e-4, double load = 10e3) {
  const std::string friction = tangential.empty() ? "" : fmt::format("tangential = \"{}\"\n", tangential);
  const std::string text =
      fmt::format(
          "[material.steel]\nshear_modulus = 82e9\npoissons_ratio = 0.28\n[contact]\nfriction = 0.3\n"
          "[shape.wheel]\nwheel_profile = {{ name = \"s1002\", radius = 0.46 }}\n[shape.rail]\nrail_profile = {{ name "
          "= "
          "\"uic60\", cant = {:.17g} }}\n"
          "[patch]\nload = {:.17g}\nlateral_shift = {:.17g}\nyaw = {:.17g}\nroll = {:.17g}\nrolling_radius = "
          "{:.17g}\nside = "
          "\"{}\"\nnormal = \"{}\"\n{}grid = {{ dx = {:.17g}, dy = {:.17g} }}\n",
          std::atan(1.0 / 40.0), load, 1e-3 * r.shift, r.yaw, r.roll, -2.0 / r.pitch_rate, r.side, normal, friction,
          cell, cell) +
      more;
  const PatchReading reading = read_patch_text(text, "case.toml", {});
  for (const auto& p : reading.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(reading.patch);
  return evaluate_patch(*reading.patch).front();
}

}  // namespace

TEST_CASE("boundary elements on wheel and rail agree with the Manchester benchmark", "[physics][wheel_rail][long]") {
  const auto all = rows();
  REQUIRE(all.size() == 19);
  for (const Row& r : all) {
    INFO(r.side << " " << r.shift << " mm");
    const PatchResult q = evaluate(r, "half-space", "half-space");
    REQUIRE(q.contacts.size() == 1);
    const PatchContact& c = q.contacts.front();
    // Far inside the 2 % and 0.1 mm that are asked for. On the gauge corner at 5 mm a tenth of a micrometre of the
    // approach moves a percent of the load between two regions; at 6 mm the patch moves by three times what a profile
    // does; from 7 mm on it is 1 mm wide, five cells (the case below says what their number means).
    const bool flange = r.shift > 5.5, corner = r.side == "right" && r.shift == 5.0;
    CHECK(q.normal_force == Approx(r.N).epsilon(0.002));
    CHECK(q.max_pressure == Approx(1e6 * r.p0).epsilon(corner ? 0.016 : flange ? 0.009 : 0.002));
    CHECK(q.approach == Approx(1e-3 * r.approach).epsilon(corner ? 0.011 : flange ? 0.008 : 0.002));
    CHECK(c.point.y() == Approx(1e-3 * r.y).margin(corner ? 0.03e-3 : flange ? 0.011e-3 : 0.003e-3));
    CHECK(c.point.x() == Approx(1e-3 * r.x).margin(corner ? 0.05e-3 : flange ? 0.02e-3 : 0.003e-3));
    CHECK(c.angle == Approx(r.angle).margin(corner || flange ? 0.0005 : 0.0001));
    CHECK(q.area == Approx(0.04e-6 * r.cells).epsilon(flange ? 0.013 : corner ? 0.01 : 0.003));
    // forces over mu N; where part of the patch sticks (0 and 0.5 mm) the reference itself is 1.5 % from its limit
    CHECK(std::hypot(q.force.fx - r.fx, q.force.fy - r.fs) < (flange ? 0.012 : 0.006) * 0.3 * r.N);
  }
}

TEST_CASE("on the flange the number of cells agrees, though it is not yet the area", "[physics][wheel_rail]") {
  // Five cells across: moved by half a cell, the same grid has a tenth more of them, so that the count of the case
  // above agrees only where both grids have their middle on the same place of the rail within 0.01 mm. A grid of a
  // quarter has 4 to 8 % less area; Hertz' own from force and peak, 3 N / (2 p0), is less by 8 to 11 %.
  for (const Row& r : rows()) {
    if (r.shift < 6.5) continue;
    INFO(r.shift << " mm");
    const PatchResult fine = evaluate(r, "half-space", "coulomb", "", 5e-5);
    CHECK(fine.area < 0.97 * 0.04e-6 * r.cells);
    CHECK(fine.area > 0.92 * 0.04e-6 * r.cells);
    CHECK(fine.max_pressure == Approx(1e6 * r.p0).epsilon(0.02));
  }
}

TEST_CASE("gauge corner and tread, 10 mm apart, share the load by the influence between them",
          "[physics][wheel_rail]") {
  // The right wheel at 5 mm. The reference lets regions whose edges are 6.7 mm apart press on each other with 39 % of
  // the half-space's influence; the tread's part bears the more, and the corner's peak is lower, the less influence.
  const auto all = rows();
  const Row& r =
      *std::find_if(all.begin(), all.end(), [](const Row& o) { return o.side == "right" && o.shift == 5.0; });
  const PatchResult shared = evaluate(r, "half-space", "coulomb"),
                    whole = evaluate(r, "half-space", "coulomb", "influence = { full = inf, none = inf }\n"),
                    apart = evaluate(r, "half-space", "coulomb", "influence = { full = 0, none = 1e-3 }\n");
  CHECK(whole.max_pressure > 1.005 * shared.max_pressure);
  CHECK(apart.max_pressure < shared.max_pressure);
  CHECK(whole.approach > 1.02 * shared.approach);
  CHECK(apart.approach < 0.99 * shared.approach);
  // so does the place that counts both overlaps: the more the tread bears, the nearer
  CHECK(whole.contacts.front().point.y() > shared.contacts.front().point.y() + 0.05e-3);
}

TEST_CASE("strips keep within 0.2 % of the peak pressure, 0.8 % on the gauge corner", "[physics][wheel_rail]") {
  for (const Row& r : rows()) {
    if (r.shift > 6.0) continue;
    INFO(r.side << " " << r.shift << " mm");
    const PatchResult q = evaluate(r, "semi-hertz", "fastsim");
    // the corner at 5 mm against our own boundary elements, which stand 1.5 % above the reference there
    const bool two = r.side == "right" && r.shift == 5.0, corner = r.side == "right" && r.shift >= 5.0;
    const double p0 = two ? evaluate(r, "half-space", "fastsim").max_pressure : 1e6 * r.p0;
    CHECK(q.max_pressure == Approx(p0).epsilon(corner ? 0.008 : 0.002));
    CHECK(q.approach == Approx(1e-3 * r.approach).epsilon(corner ? 0.012 : 0.002));
    if (r.shift >= 1.0 && !two)  // FASTSIM takes one ellipse for two regions there, and says so
      CHECK(std::hypot(q.force.fx - r.fx, q.force.fy - r.fs) < 0.017 * 0.3 * r.N);  // KPEC + FASTSIM: 0.024
  }
}

TEST_CASE("where two hills of pressure part, strips are within 1 % of boundary elements", "[physics][wheel_rail]") {
  // the right wheel between the jump and 1 mm, of which the benchmark has no row: the patch is 17 mm wide
  Row r = rows().front();
  r.side = "right";
  for (const double shift : {0.2, 0.3, 0.4, 0.5, 0.6, 0.75}) {
    INFO(shift << " mm");
    r.shift = shift;
    r.yaw = 2.4e-3 * shift;
    r.roll = -4.6e-5 * shift;
    const PatchResult truth = evaluate(r, "half-space", "coulomb"), q = evaluate(r, "semi-hertz", "coulomb");
    CHECK(q.max_pressure == Approx(truth.max_pressure).epsilon(0.01));
    CHECK(q.approach == Approx(truth.approach).epsilon(0.003));
    CHECK(q.area == Approx(truth.area).epsilon(0.03));
  }
}

TEST_CASE("strips settle at every place and load", "[physics][wheel_rail]") {
  Row r = rows().front();
  for (const char* side : {"left", "right"}) {
    r.side = side;
    for (const double load : {1e3, 1e4, 4e4, 1e5}) {
      for (const double shift : {0.0, 0.1, 0.2, 0.3, 0.5, 1.0, 3.0, 5.0, 6.0, 7.0}) {
        INFO(side << " " << shift << " mm " << load << " N");
        r.shift = shift;
        r.yaw = 2.4e-3 * shift;
        r.roll = shift < 6.5 ? -6e-5 * shift : -0.0064;
        for (const std::string& reason : evaluate(r, "semi-hertz", "", "", 2e-4, load).reasons)
          CHECK(reason.find("conformal") != std::string::npos);
      }
    }
  }
}

TEST_CASE("a strip between two hills about to meet does not take a pressure without bound", "[physics][wheel_rail]") {
  // centred wheels from 7.8 to 8.7 kN: strips that had shrunk to nothing held 35 GPa, unsaid, beside 0.32
  Row r = rows().front();
  r.shift = r.yaw = r.roll = 0.0;
  for (const char* side : {"left", "right"}) {
    r.side = side;
    const double before = evaluate(r, "semi-hertz", "", "", 2e-4, 7.8e3).max_pressure;
    for (double load = 7.9e3; load < 8.75e3; load += 50.0) {
      INFO(side << " " << load << " N");
      const PatchResult q = evaluate(r, "semi-hertz", "", "", 2e-4, load);
      CHECK(q.reasons.empty());
      CHECK(q.max_pressure == Approx(before * std::cbrt(load / 7.8e3)).epsilon(0.025));  // its own error estimate
    }
  }
}

TEST_CASE("analyn knows its error: silent within 1.5 %, said where it is more", "[physics][wheel_rail]") {
  Row r = rows().front();
  for (const char* side : {"left", "right"}) {
    r.side = side;
    for (const double load : {1e3, 1e4, 4e4, 1e5}) {
      for (const double shift : {0.0, 0.2, 0.5, 1.0, 2.0, 4.0}) {
        INFO(side << " " << shift << " mm " << load << " N");
        r.shift = shift;
        r.yaw = 2.4e-3 * shift;
        r.roll = -5.6e-5 * shift;
        const double truth = evaluate(r, "semi-hertz", "", "", 2e-4, load).max_pressure;
        const PatchResult q = evaluate(r, "analyn", "", "", 2e-4, load);
        const double error = std::abs(q.max_pressure / truth - 1.0);
        if (q.reasons.empty()) CHECK(error < 0.015);
        if (error > 0.04) CHECK_FALSE(q.reasons.empty());
        CHECK(error < q.error_estimate + 0.012);  // of the strips that stand for the truth here
      }
    }
  }
}

TEST_CASE("creepages of a rolling wheelset are those of the benchmark", "[physics][wheel_rail]") {
  // Kalker's linear theory is linear: tiny friction-free creepages would do, but the forces of Coulomb's law show the
  // direction
  for (const Row& r : rows()) {
    if (r.shift < 1.0 || (r.side == "right" && r.shift == 5.0)) continue;  // forces of two places add up there
    INFO(r.side << " " << r.shift << " mm");
    const PatchResult q = evaluate(r, "semi-hertz", "coulomb");
    // the reference position is not the centre of pressure: spin times 0.2 mm
    CHECK(std::atan2(q.force.fy, q.force.fx) == Approx(std::atan2(-r.eta, -r.xi)).margin(0.03));
  }
}

TEST_CASE("models that need a parabola say so at the jump and are silent away from it", "[physics][wheel_rail]") {
  for (const Row& r : rows()) {
    if (r.side != "left" || (r.shift != 0.0 && r.shift < 1.0)) continue;
    INFO(r.shift << " mm");
    for (const char* model : {"hertz", "kik-piotrowski"})
      CHECK(evaluate(r, model, "fastsim").reasons.empty() == (r.shift > 0.0));
    CHECK(evaluate(r, "half-space", "half-space").reasons.empty());
  }
}

TEST_CASE("virtual penetration is within 1 % or says why not", "[physics][wheel_rail]") {
  int idle = 0;  // doubts where the answer is right
  for (const Row& r : rows()) {
    INFO(r.side << " " << r.shift << " mm");
    const PatchResult q = evaluate(r, "kik-piotrowski", "fastsim");
    const double error =
        std::max(std::abs(q.max_pressure / (1e6 * r.p0) - 1.0), std::abs(q.approach / (1e-3 * r.approach) - 1.0));
    if (q.reasons.empty()) CHECK(error < (r.shift < 5.5 ? 0.01 : 0.03));  // flange: 1.6 mm wide
    if (r.shift < 5.5 && q.reasons.empty()) CHECK(error < 0.02);
    if (r.shift < 5.5 && !q.reasons.empty() && error < 0.02) ++idle;
  }
  CHECK(idle <= 1);  // beside the jump, where the pressures leave 1 % of the approach open
}

namespace {

struct FlagRow {
  std::string text;
  const char *normal, *tangential, *reason;  ///< reason empty: silent
};

const std::string flag_steel =
    "[material.steel]\nshear_modulus = 82e9\npoissons_ratio = 0.28\n[contact]\nfriction = 0.3\n";

std::string flag_ellipse(double a, double b, double longitudinal, double spin) {
  return flag_steel +
         fmt::format(
             "[patch]\nsemi_axes = {{ a = {}, b = {} }}\nload = 82e3\ncreepage = {{ longitudinal = {}, lateral = "
             "0.0, spin = {} }}\n",
             a, b, longitudinal, spin);
}

std::string flag_wheel(double y, double yaw, double roll, const char* side, const char* load, const char* more = "") {
  return flag_steel +
         "[shape.wheel]\nwheel_profile = { name = \"s1002\" }\n[shape.rail]\nrail_profile = { name = \"uic60\", cant = "
         "0.025 }\n" +
         fmt::format("[patch]\nload = {}\nlateral_shift = {}\nyaw = {}\nroll = {}\nside = \"{}\"\n{}", load, y, yaw,
                     roll, side, more);
}

void check_flags(const std::vector<FlagRow>& rows) {
  for (const FlagRow& row : rows) {
    const std::string models = fmt::format("normal = \"{}\"\n", row.normal) +
                               (*row.tangential ? fmt::format("tangential = \"{}\"\n", row.tangential) : std::string());
    const PatchReading reading = read_patch_text(row.text + models, "case.toml", {});
    REQUIRE(reading.patch);
    const PatchResult q = evaluate_patch(*reading.patch).front();
    std::string all;
    for (const auto& r : q.reasons) all += r + "; ";
    INFO(row.text << models << "reasons: " << all);
    if (*row.reason)
      CHECK(all.find(row.reason) != std::string::npos);
    else
      CHECK(all == "");
  }
}

}  // namespace

TEST_CASE("where a creep law leaves its range it says why, and elsewhere it is silent", "[physics][wheel_rail]") {
  const std::string spin = flag_ellipse(8e-3, 4e-3, 0.0, 2.0), large_spin = flag_ellipse(8e-3, 4e-3, 0.0, 6.94),
                    pure = flag_ellipse(8e-3, 4e-3, 0.001, 0.0), tiny = flag_ellipse(8e-3, 4e-3, 1e-5, 0.0),
                    circle = flag_ellipse(5e-3, 5e-3, 0.001, 0.0), slender = flag_ellipse(1e-3, 8e-3, 0.001, 0.0);
  const std::string conformal =
      flag_steel + "[patch]\nradii = { x1 = 0.46, x2 = inf, y1 = 0.013, y2 = -0.0145 }\nload = 80e3\n";
  std::string plastic = pure;
  plastic.replace(plastic.find("poissons_ratio"), 0, "shear_yield = 100e6\n");
  check_flags({{spin, "hertz", "shen-hedrick-elkins", "spin"},
               {spin, "hertz", "polach", "spin"},
               {spin, "hertz", "vermeulen-johnson", "spin"},
               {large_spin, "hertz", "fastsim", "46 %"},
               {large_spin, "hertz", "fastsim-elliptic", ""},
               {large_spin, "hertz", "fastrip", ""},
               {large_spin, "hertz", "half-space", ""},
               {pure, "hertz", "shen-hedrick-elkins", ""},
               {pure, "hertz", "polach", ""},
               {pure, "hertz", "fastsim", ""},
               {pure, "hertz", "kalker-linear", "linear theory"},
               {tiny, "hertz", "kalker-linear", ""},
               {tiny, "hertz", "coulomb", "sticks"},
               {circle, "hertz", "strip", "slender"},
               {slender, "hertz", "strip", ""},
               {conformal, "hertz", "", "conformal"},
               {conformal, "half-space", "", "conformal"},
               {plastic, "hertz", "fastsim", "plastic"}});
}

TEST_CASE("where a normal model leaves its range it says why, and elsewhere it is silent", "[physics][wheel_rail]") {
  const std::string jump = flag_wheel(0.0, 0.0, 0.0, "left", "10e3"), heavy = flag_wheel(0.0, 0.0, 0.0, "left", "40e3"),
                    beside = flag_wheel(0.2e-3, 0.48e-3, -1e-5, "right", "10e3"),
                    tread = flag_wheel(3e-3, 0.0072, -0.0001803, "left", "10e3"),
                    corner = flag_wheel(5e-3, 0.012, -0.0003554, "right", "10e3");
  const auto cells = [](const char* grid) { return flag_wheel(0.5e-3, 0.0012, -2.5e-5, "left", "10e3", grid); };
  const std::string coarse = cells("grid = { dx = 8e-4, dy = 8e-4 }\n"),
                    fine = cells("grid = { dx = 2e-4, dy = 2e-4 }\n");
  check_flags({{jump, "hertz", "", "parabola"},
               {jump, "kik-piotrowski", "", "parabola"},
               {jump, "stripes", "", "parabola"},
               {jump, "multi-hertz", "", "parabola"},
               {jump, "analyn", "", "do not close the gap"},
               {beside, "analyn", "", "do not close the gap"},
               {heavy, "analyn", "", "do not close the gap"},
               {beside, "stripes", "", "do not close the gap"},
               {beside, "semi-hertz", "", ""},
               {heavy, "semi-hertz", "", ""},
               {jump, "semi-hertz", "", ""},
               {jump, "half-space", "", ""},
               {jump, "semi-hertz", "fastsim", "not an ellipse"},
               {tread, "hertz", "", ""},
               {tread, "multi-hertz", "", ""},
               {tread, "kik-piotrowski", "", ""},
               {tread, "stripes", "", ""},
               {tread, "analyn", "", ""},
               {tread, "semi-hertz", "fastsim", ""},
               {tread, "half-space", "half-space", ""},
               {corner, "hertz", "", "second region"},
               {corner, "kik-piotrowski", "", "second region"},
               {corner, "stripes", "", "second region"},
               {corner, "analyn", "", "second region"},
               {corner, "semi-hertz", "fastsim", "not an ellipse"},
               {corner, "half-space", "", "conformal"},
               {coarse, "half-space", "half-space", "coarse grid"},
               {fine, "half-space", "half-space", ""}});
}

TEST_CASE("a gap whose samples all stay open carries nothing", "[physics][wheel_rail]") {
  using Triangle = std::array<std::uint32_t, 3>;
  class Nowhere final : public GapSource {  // what is asked of it here is in the region already
   public:
    std::vector<ContactRegion> regions() const override { return {}; }
    ContactRegion moved(const ContactRegion& r, double, double) const override { return r; }
    double angle_at(const ContactRegion&, double) const override { return 0.0; }
    GapField field(const ContactRegion&, double, double, double, double, std::size_t, std::size_t) const override {
      return {};
    }
    std::unique_ptr<GapOperator> gaps_between(GapMethod, std::span<const Vec3>, std::span<const Triangle>,
                                              std::span<const Triangle>, double) const override {
      return nullptr;
    }
  };
  const Nowhere source;
  std::vector<ContactRegion> regions(1);
  ContactRegion& r = regions[0];
  r.curvature_x = 2.0;
  r.curvature_y = 3.0;
  r.profile.start = -2e-3;
  r.profile.step = 1e-4;
  for (std::size_t k = 0; k < 41; ++k) {
    const double y = r.profile.y(k);
    r.profile.gap.push_back(2e-9 + 1.5 * y * y);
    r.profile.curvature_x.push_back(2.0);
    r.profile.centre_x.push_back(0.0);
  }
  const ElasticPair steel{82e9, 0.28, 0.0};
  for (const NormalModel& model : all_normal_models()) {
    if (model.entry.name != "semi-hertz" && model.entry.name != "kik-piotrowski") continue;  // they take the samples
    INFO(model.entry.name);
    NormalInput in{source, regions, steel, {false, 1e-9}};
    in.approach = 1e-9;
    CHECK(model.solve(in).front().patch.normal_force == 0.0);
  }
}
