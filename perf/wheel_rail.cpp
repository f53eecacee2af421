/// @file wheel_rail.cpp  Price and error of the patch models, one thread, processor time, best of many calls. Errors:
/// laws against the half-space solution of the 8 by 4 mm ellipse on 176 x 176 cells, extrapolated; normal contact
/// against Hertz; whole evaluations of S1002 on UIC60 (`perf_wheel_rail whole` for these alone) against boundary
/// elements on 0.2 mm.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "engine/threads/parallel.h"
#include "laws/wheel_rail/half_space/normal.h"
#include "laws/wheel_rail/half_space/tangential.h"
#include "laws/wheel_rail/tangential/polach.h"
#include "laws/wheel_rail/tangential/shen_hedrick_elkins.h"
#include "laws/wheel_rail/tangential/strip_theory.h"
#include "laws/wheel_rail/tangential/vermeulen_johnson.h"
#include "scenes/patch/evaluate_patch.h"

using namespace epafi;

namespace {

template <class F>
double best_seconds(int rounds, int calls, const F& f) {
  double best = 1e9;
  for (int r = 0; r < rounds; ++r) {
    const std::clock_t start = std::clock();
    for (int c = 0; c < calls; ++c) f();
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / calls);
  }
  return best;
}

volatile double sink;

/// The creepages at which the laws are compared, on the ellipse of 8 by 4 mm.
struct LawCase {
  const char* name;
  Creepage creepage;
};
constexpr double load = 82e3, friction = 0.3;
const ElasticPair soft_steel{82e9, 0.28, 0.0};
const Ellipse ellipse{8e-3, 4e-3};

PatchForce half_space_force(const Creepage& creepage, std::uint32_t nx, std::uint32_t ny) {
  return solve_extrapolated(bound_of_ellipse(ellipse, load, friction, nx, ny), soft_steel, creepage).force;
}

/// Rows of one creepage: seconds of a call and error of its force over mu N.
class LawRows {
 public:
  explicit LawRows(const LawCase& c)
      : name_(c.name),
        case_{ellipse, load, soft_steel, friction, c.creepage},
        truth_(half_space_force(c.creepage, 176, 176)) {}

  template <class F>
  void row(const std::string& law, int rounds, int calls, const F& force) {
    PatchForce f;
    const double seconds = best_seconds(rounds, calls, [&] {
      case_.creepage.lateral += 1e-15;  // no call is the one before
      f = force(case_);
      sink = f.fx;
    });
    std::printf("%-20s %-28s %12.3e %10.4f\n", name_, law.c_str(), seconds,
                std::hypot(f.fx - truth_.fx, f.fy - truth_.fy) / case_.bound());
  }

 private:
  const char* name_;
  RollingCase case_;
  PatchForce truth_;
};

void laws() {
  const KalkerCoefficients k = kalker_coefficients(2.0, 0.28);
  for (const LawCase& c : {LawCase{"longitudinal 0.001", {-0.001, 0, 0}},
                           LawCase{"lateral, spin", {0, -0.000625, 0.625}}, LawCase{"spin 1 /m", {0, 0, 1.0}}}) {
    LawRows rows(c);
    rows.row("shen-hedrick-elkins", 20, 20000, [](const RollingCase& r) { return shen_hedrick_elkins(r); });
    rows.row("polach", 20, 20000, [](const RollingCase& r) { return polach(r); });
    rows.row("vermeulen-johnson", 20, 20000, [](const RollingCase& r) { return vermeulen_johnson(r); });
    for (const std::uint32_t n : {11u, 22u, 44u, 88u}) {
      const std::string cells = fmt::format(" {}x{}", n, n);
      rows.row("fastsim" + cells, 20, 20, [&](const RollingCase& r) {
        return fastsim(strips_of_ellipse(ellipse, load, n, n, Bound::parabolic),
                       kalker_flexibility(r, k, FlexibilityRule::blended), friction, r.creepage, false)
            .force;
      });
      rows.row("fastrip" + cells, 20, 20, [&](const RollingCase& r) {
        return fastrip(strips_of_ellipse(ellipse, load, n, n, Bound::elliptic), r, k, false).force;
      });
      rows.row("half-space, extrapolated" + cells, 2, 1,
               [&](const RollingCase& r) { return half_space_force(r.creepage, n, n); });
    }
    rows.row("half-space 64x32", 2, 1, [](const RollingCase& r) { return half_space_force(r.creepage, 64, 32); });
  }
}

void normal() {
  const ElasticPair steel{210e9 / 2.6, 0.3, 0.0};
  const double A = 0.5 / 0.46, B = 0.5 / 0.3;
  const HertzContact h = hertz_of_force(A, B, steel.effective_modulus(), 80e3);
  for (const std::size_t n : {16u, 32u, 64u, 128u, 256u, 560u}) {
    const PatchGrid g{n, n, 2.2 * h.ellipse.a / static_cast<double>(n), 2.2 * h.ellipse.b / static_cast<double>(n)};
    std::vector<double> gap(g.size());
    for (std::size_t k = 0; k < gap.size(); ++k) gap[k] = A * g.x(k % n) * g.x(k % n) + B * g.y(k / n) * g.y(k / n);
    HalfSpaceNormal s;
    const double seconds = best_seconds(n > 200 ? 1 : 3, 1, [&] {
      s = solve_half_space_normal(g, gap, steel, {true, 80e3}, 1e-6);
    });
    std::printf("normal %4zux%-4zu %8.0f in contact, %3d rounds %12.3e s   p0 %9.2e   approach %9.2e\n", n, n,
                s.area / g.cell(), s.report.iterations, seconds, std::abs(s.max_pressure / h.max_pressure - 1.0),
                std::abs(s.approach / h.approach - 1.0));
  }
}

/// The benchmark's wheelset at one place.
PatchCase benchmark_case(const char* side, double shift) {
  const std::string text = fmt::format(
      "[material.steel]\nshear_modulus = 82e9\npoissons_ratio = 0.28\n[contact]\nfriction = 0.3\n[shape.wheel]\n"
      "wheel_profile = {{ name = \"s1002\", radius = 0.46 }}\n[shape.rail]\nrail_profile = {{ name = \"uic60\", "
      "cant = \"= atan(1/40)\" }}\n[patch]\nload = 10e3\nlateral_shift = {}e-3\nyaw = {}\nside = \"{}\"\n"
      "tangential = \"fastsim\"\ngrid = {{ dx = 2e-4, dy = 2e-4 }}\n",
      shift, 2.4e-3 * shift, side);
  return *read_patch_text(text, "case.toml", {}).patch;
}

/// Search, normal and tangential model of the benchmark's wheelset, profiles kept: milliseconds and error of the peak.
void whole() {
  std::printf("%-6s %6s %-16s %10s %10s %10s\n", "side", "mm", "model", "ms", "peak", "approach");
  for (const char* side : {"left", "right"}) {
    for (const double shift : {0.0, 0.2, 0.5, 0.75, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
      PatchCase c = benchmark_case(side, shift);
      c.normal = {"half-space"};
      const PatchResult truth = evaluate_patch(c).front();
      for (const char* model : {"semi-hertz", "analyn", "kik-piotrowski"}) {
        c.normal = {model};
        PatchResult r;
        const double seconds = best_seconds(7, 10, [&] { r = evaluate_patch(c).front(); });
        std::printf("%-6s %6.2f %-16s %10.3f %9.2f%% %9.2f%%\n", side, shift, model, 1e3 * seconds,
                    100.0 * (r.max_pressure / truth.max_pressure - 1.0), 100.0 * (r.approach / truth.approach - 1.0));
      }
    }
  }
}

/// One place of that table by one model, a thousand times: for a profiler.
void one(const char* side, double shift, const char* model) {
  PatchCase c = benchmark_case(side, shift);
  c.normal = {model};
  const double seconds = best_seconds(5, 200, [&] { evaluate_patch(c); });
  std::printf("%-6s %6.2f %-16s %10.3f ms\n", side, shift, model, 1e3 * seconds);
}

}  // namespace

int main(int count, char** words) {
  set_thread_count(1);
  if (count > 4 && std::strcmp(words[1], "whole") == 0) {
    one(words[2], std::atof(words[3]), words[4]);
    return 0;
  }
  if (count > 1 && std::strcmp(words[1], "whole") == 0) {
    whole();
    return 0;
  }
  normal();
  std::printf("%-20s %-28s %12s %10s\n", "creepage", "law", "seconds", "error/muN");
  laws();
  whole();
}
