// What every model of a contact says of itself, against boundary elements: no failure in silence, few alarms without
// one. Tables of all models over wheel and rail at every place and load, and over ellipses with every mix of creepages.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scenes/patch/evaluate_patch.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

const std::string steel_text =
    "[material.steel]\nshear_modulus = 82e9\npoissons_ratio = 0.28\n[contact]\nfriction = 0.3\n";

std::vector<PatchResult> evaluate(const std::string& text) {
  const PatchReading reading = read_patch_text(steel_text + text, "case.toml", {});
  for (const auto& p : reading.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(reading.patch);
  return evaluate_patch(*reading.patch);
}

/// What one model did over all cases.
struct Count {
  int silent = 0, flagged = 0, idle = 0, conformal = 0;  ///< idle: flagged though nothing is wrong
  double worst = 0.0, beyond = 0.0;                      ///< in silence: error, and by how much more than its estimate
};

void print(const std::map<std::string, Count>& table, const char* unit) {
  std::string text =
      fmt::format("{:20} {:>7} {:>8} {:>8} {:>5} worst in silence\n", "model", "silent", "flagged", "conform", "idle");
  for (const auto& [name, c] : table)
    text += fmt::format("{:20} {:7} {:8} {:8} {:5} {:.4f} {}\n", name, c.silent, c.flagged, c.conformal, c.idle,
                        c.worst, unit);
  WARN(text);
}

}  // namespace

TEST_CASE("normal models: no peak off by more than 3.2 % in silence, few alarms without cause",
          "[physics][wheel_rail][slow]") {
  std::map<std::string, Count> table;
  for (const char* side : {"left", "right"}) {
    for (const double y : {0.0, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 5.5, 6.0, 6.6, 7.0}) {
      for (const double load : {1e3, 8e3, 14e3, 4e4, 1e5}) {
        const std::vector<PatchResult> all = evaluate(fmt::format(
            "[shape.wheel]\nwheel_profile = {{ name = \"s1002\", radius = 0.46 }}\n[shape.rail]\nrail_profile = {{ "
            "name "
            "= \"uic60\", cant = \"= atan(1/40)\" }}\n[patch]\nload = {}\nlateral_shift = {}e-3\nyaw = {}\nside = "
            "\"{}\"\nnormal = [\"half-space\", \"hertz\", \"multi-hertz\", \"kik-piotrowski\", \"stripes\", "
            "\"analyn\", "
            "\"semi-hertz\"]\n",
            load, y, 2.4e-3 * y, side));
        const PatchResult& truth = all.front();
        for (auto q = all.begin() + 1; q != all.end(); ++q) {
          INFO(side << " " << y << " mm " << load << " N " << q->normal);
          Count& c = table[q->normal];
          const double peak = std::abs(q->max_pressure / truth.max_pressure - 1.0),
                       approach = std::abs(q->approach / truth.approach - 1.0),
                       area = std::abs(q->area / truth.area - 1.0);
          if (q->reasons.empty()) {
            ++c.silent;
            c.worst = std::max(c.worst, peak);
            c.beyond = std::max(c.beyond, peak - q->error_estimate);
            CHECK(peak < 0.032);
            CHECK(peak < q->error_estimate + 0.005);
            CHECK(approach < 0.03);
            CHECK(area < 0.16);  // Hertz beside the jump
            continue;
          }
          // conformal: boundary elements of half-spaces say the same of themselves, and are no truth then
          const bool conformal = std::any_of(q->reasons.begin(), q->reasons.end(),
                                             [](const std::string& r) { return r.find("conformal") == 0; });
          conformal ? ++c.conformal : ++c.flagged;
          c.idle += !conformal && peak < 0.01 && approach < 0.01 && area < 0.03;
        }
      }
    }
  }
  print(table, "of the peak");
  for (const auto& [name, c] : table) {
    INFO(name);
    CHECK(c.silent > 50);
    CHECK(c.idle <= 0.05 * c.flagged);
  }
}

TEST_CASE("creep laws: none off by more than 0.09 mu N in silence, few alarms without cause",
          "[physics][wheel_rail][slow]") {
  std::map<std::string, Count> table;
  for (const double ratio : {0.2, 0.5, 1.0, 2.0, 4.0}) {
    for (const char* kind : {"long", "lat", "spin", "lat and spin", "lat against spin", "long and spin"}) {
      for (const double s : {0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0}) {
        // creepage in mu N / (3 G a b), spin in mu N / (G (a b)^1.5), a third of it where mixed; sqrt(a b) = 6 mm
        const double e = s * 0.3 * 82e3 / (3.0 * 82e9 * 36e-6), p = 3.0 * e / 6e-3;
        const std::string k = kind;
        const bool mixed = k.find(' ') != std::string::npos;
        const double xi = k.starts_with("long") ? -e : 0.0, eta = k.starts_with("lat") ? e : 0.0,
                     phi = k == "long" || k == "lat" ? 0.0
                           : mixed                   ? (k == "lat against spin" ? -p / 3.0 : p / 3.0)
                                                     : p;
        const std::vector<PatchResult> all = evaluate(fmt::format(
            "[patch]\nsemi_axes = {{ a = {}, b = {} }}\nload = 82e3\ncreepage = {{ longitudinal = {}, lateral = {}, "
            "spin = {} }}\ntangential = [\"half-space\", \"kalker-linear\", \"vermeulen-johnson\", "
            "\"shen-hedrick-elkins\", \"polach\", \"coulomb\", \"fastsim\", \"fastsim-elliptic\", \"strip\", "
            "\"fastrip\"]\n",
            6e-3 * std::sqrt(ratio), 6e-3 / std::sqrt(ratio), xi, eta, phi));
        const PatchForce& truth = all.front().force;
        CHECK(all.front().reasons.empty());
        for (auto q = all.begin() + 1; q != all.end(); ++q) {
          INFO("a/b " << ratio << " " << kind << " " << s << " " << q->tangential);
          Count& c = table[q->tangential];
          const double off = std::hypot(q->force.fx - truth.fx, q->force.fy - truth.fy) / (0.3 * 82e3);
          if (q->reasons.empty()) {
            ++c.silent;
            c.worst = std::max(c.worst, off);
            c.beyond = std::max(c.beyond, off - q->error_estimate);
            CHECK(off < 0.09);
            CHECK(off < q->error_estimate + 0.012);
          } else {
            ++c.flagged;
            c.idle += off < 0.02;
          }
        }
      }
    }
  }
  print(table, "mu N");
  for (const auto& [name, c] : table) {
    INFO(name);
    CHECK(c.silent >= 18);
    // strips on a patch that slides as a whole, Polach at small spin: right without knowing it
    CHECK(c.idle <= (name == "strip" || name == "fastrip" ? 0.2 : 0.13) * c.flagged);
  }
}
