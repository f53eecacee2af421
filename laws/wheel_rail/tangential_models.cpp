#include "laws/wheel_rail/tangential_models.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "laws/wheel_rail/tangential/half_space_models.h"
#include "laws/wheel_rail/tangential/polach.h"
#include "laws/wheel_rail/tangential/shen_hedrick_elkins.h"
#include "laws/wheel_rail/tangential/strip_theory.h"
#include "laws/wheel_rail/tangential/vermeulen_johnson.h"

namespace epafi {
namespace {

RollingCase case_of(const TangentialInput& in) {
  const NormalPatch& p = in.patch;
  return {p.ellipse, p.normal_force, in.elastic, in.friction, creepage_at(in.creepage, p.centre_x, p.centre_y)};
}

KalkerCoefficients coefficients(const RollingCase& c) {
  return kalker_coefficients(c.ellipse.a / c.ellipse.b, c.elastic.poissons_ratio);
}

/// Saturation of the patch by creepages, and proportion of spin: these decide whether a law is within its range.
struct Regime {
  double saturation;  ///< linear force of all creepages over mu N
  double spin_share;  ///< of that force, in [0, 1]
  double against;     ///< cancelled part of the linear forces of spin and lateral creepage, in [0, 1]
  double crossed;     ///< how much of them is spin and longitudinal creepage in equal parts, in [0, 1]
  double rim;         ///< slip by spin at the patch's far end over that and the slip by creepage, in [0, 1]
};
Regime regime_of(const RollingCase& c, const KalkerCoefficients& k) {
  const double ab = c.ellipse.a * c.ellipse.b, Gab = c.elastic.shear_modulus * ab;
  const double x = k.c11 * std::abs(c.creepage.longitudinal), y = k.c22 * c.creepage.lateral,
               s = std::sqrt(ab) * k.c23 * c.creepage.spin, spin = std::abs(s), sum = x + std::abs(y) + spin;
  const double creep = std::hypot(x, y), end = std::max(c.ellipse.a, c.ellipse.b) * std::abs(c.creepage.spin),
               slip = std::hypot(c.creepage.longitudinal, c.creepage.lateral) + end;
  if (!(sum > 0.0)) return {};
  return {c.bound() > 0.0 ? Gab * (creep + spin) / c.bound() : 0.0, spin / (creep + spin),
          y * s < 0.0 ? 2.0 * std::min(std::abs(y), spin) / sum : 0.0, 2.0 * std::min(x, spin) / sum, end / slip};
}

struct PreparedCase {
  RollingCase rolling;
  KalkerCoefficients coefficients;
  Regime regime;
};
PreparedCase prepared(const TangentialInput& in) {
  const RollingCase rolling = case_of(in);
  const KalkerCoefficients k = coefficients(rolling);
  return {rolling, k, regime_of(rolling, k)};
}

void check_materials(const TangentialInput& in, TangentialOutcome& out) {
  if (std::abs(in.elastic.coupling) > most_coupling)
    out.reasons.push_back("unlike materials couple pressure and traction, which is left out");
}

/// Linear force of all creepages over mu N; where it is small, a tolerance relative to mu N is too coarse.
double saturation_of(const TangentialInput& in) {
  const RollingCase c = case_of(in);
  return regime_of(c, coefficients(c)).saturation;
}

/// Common to all laws that know the patch by its ellipse alone.
void check_ellipse(const TangentialInput& in, const KalkerCoefficients& k, TangentialOutcome& out) {
  if (in.patch.is_line)
    out.reasons.push_back("a law for ellipses on a line contact: the ellipse of the same axes was taken");
  if (k.extrapolated) out.reasons.push_back("axis ratio a/b outside Kalker's table [0.1, 10]");
  const double area = std::numbers::pi * in.patch.ellipse.a * in.patch.ellipse.b;
  if (!in.patch.is_ellipse && std::abs(in.patch.area / area - 1.0) > 0.15)
    out.reasons.push_back("the patch is not an ellipse: its area and its second moments disagree");
  check_materials(in, out);
}

double dissipation(const PatchForce& f, const Creepage& c) {
  return std::abs(f.fx * c.longitudinal) + std::abs(f.fy * c.lateral) + std::abs(f.mz * c.spin);
}

// Error estimates below are fits to the distances to the half-space solution over 270 points: a/b from 0.2 to 4,
// longitudinal, lateral creepage and spin alone, spin with and against lateral creepage and with longitudinal, 0.1 to 5
// times mu N / (G a b) or its equivalent (tests/physics/test_wheel_rail_flags.cpp). A law warns where its fit exceeds
// 0.1 mu N, or its own column of the 56 published points if that is wider.

TangentialOutcome solve_kalker_linear(const TangentialInput& in) {
  TangentialOutcome out;
  const auto [c, k, r] = prepared(in);
  out.force = kalker_linear(c, k);
  out.stick_share = 1.0;
  // spin slides first at the far ends of a patch that is wide across the track
  const double wide = std::max(1.0, std::pow(c.ellipse.b / c.ellipse.a, 0.35)),
               size = r.saturation * (1.0 + r.spin_share * (wide - 1.0));
  out.error_estimate = size - cubic_saturation(size);
  if (out.error_estimate > 0.05)
    out.reasons.push_back("creepage too large for the linear theory: part of the patch slides");
  check_ellipse(in, k, out);
  return out;
}

TangentialOutcome solve_vermeulen_johnson(const TangentialInput& in) {
  TangentialOutcome out;
  const auto [c, k, r] = prepared(in);
  out.force = vermeulen_johnson(c);
  out.error_estimate = 0.082 + r.spin_share * std::min(1.0, r.saturation);
  if (r.spin_share > 0.05) out.reasons.push_back("spin, which the law does not know");
  check_ellipse(in, k, out);
  return out;
}

TangentialOutcome solve_she(const TangentialInput& in) {
  TangentialOutcome out;
  const auto [c, k, r] = prepared(in);
  out.force = shen_hedrick_elkins(c);
  const double spin = 0.85 * r.rim * r.rim * std::min(1.0, r.saturation * r.saturation);
  out.error_estimate = std::min(0.038, 0.11 * r.saturation) + spin;
  if (spin > 0.1) out.reasons.push_back("spin: the true force falls with large spin, this one stays at mu N");
  check_ellipse(in, k, out);
  return out;
}

TangentialOutcome solve_polach(const TangentialInput& in) {
  TangentialOutcome out;
  const auto [c, k, r] = prepared(in);
  out.force = polach(c);
  out.error_estimate = std::min(0.06, 0.17 * r.saturation) + 0.47 * r.spin_share * std::min(1.0, r.saturation);
  if (r.spin_share > 0.05)
    out.reasons.push_back(
        "spin: published forms of the spin terms differ, and miss the half-space solution by up to 0.47 mu N");
  check_ellipse(in, k, out);
  return out;
}

TangentialOutcome solve_coulomb(const TangentialInput& in) {
  TangentialOutcome out;
  const Creepage s = case_of(in).creepage;
  const double size = std::hypot(s.longitudinal, s.lateral), bound = in.friction * in.patch.normal_force;
  if (size > 0.0) out.force = {-bound * s.longitudinal / size, -bound * s.lateral / size, 0.0};
  out.stick_share = 0.0;
  const auto [c, k, r] = prepared(in);
  out.error_estimate = 1.0 - cubic_saturation(r.saturation) + r.spin_share;
  if (r.saturation < 2.5) out.reasons.push_back("part of the patch sticks; Coulomb's law alone knows full slip only");
  if (r.spin_share > 0.05) out.reasons.push_back("spin, which the law does not know");
  return out;
}

TractionMap map_of_strips(const StripPatch& p, const StripSolution& s) {
  TractionMap map;
  for (const Strip& strip : p.strips) {
    for (std::uint32_t k = 0; k < strip.count; ++k) {
      map.x.push_back(strip.x(k));
      map.y.push_back(strip.y);
    }
  }
  map.pressure = p.pressure;
  map.traction_x = s.traction_x;
  map.traction_y = s.traction_y;
  map.slip_x = s.slip_x;
  map.slip_y = s.slip_y;
  map.sticks = s.sticks;
  return map;
}

StripPatch strips_of(const TangentialInput& in, Bound bound) {
  if (in.patch.is_line)
    return strip_of_line(in.patch.ellipse, in.patch.normal_force,
                         static_cast<std::uint32_t>(std::max<std::size_t>(in.cells.nx, 256)));
  if (!in.patch.is_ellipse) return strips_of_field(in.patch.grid, in.patch.pressure, bound);
  return strips_of_ellipse(in.patch.ellipse, in.patch.normal_force, static_cast<std::uint32_t>(in.cells.nx),
                           static_cast<std::uint32_t>(in.cells.ny), bound);
}

/// Largest error of the law, and error of its grid (first order: 1 / cells along the axis).
double grid_error(const TangentialInput& in) {
  const double cells =
      in.patch.is_ellipse ? static_cast<double>(in.cells.nx) : 2.0 * in.patch.ellipse.a / in.patch.grid.dx;
  return 0.5 / std::max(1.0, cells);
}

constexpr double most_hidden = 0.048;  // error over mu N that a law may have without a warning, beyond pure creepages

TangentialOutcome fastsim_on(const TangentialInput& in, Bound bound) {
  TangentialOutcome out;
  const auto [c, k, r] = prepared(in);
  const StripPatch patch = strips_of(in, bound);
  const StripSolution s =
      fastsim(patch, kalker_flexibility(c, k, FlexibilityRule::blended), in.friction, creepage_of_cells(in), in.store);
  out.force = s.force;
  out.stick_share = s.stick_share;
  if (in.store) out.map = map_of_strips(patch, s);
  const double full = std::min(1.0, r.saturation * r.saturation),
               half = std::min(1.0, 0.25 * r.saturation * r.saturation);
  const bool parabolic = bound == Bound::parabolic;
  const double pure = parabolic ? 0.035 : 0.05, more = parabolic ? 0.055 : 0.015, ratio = c.ellipse.a / c.ellipse.b;
  const double against = 0.3 * r.against * r.against * half, crossed = 0.075 * r.crossed * half;
  out.error_estimate =
      std::min(pure, 0.15 * r.saturation) + more * full * r.spin_share + against + crossed + grid_error(in);
  if (parabolic && r.spin_share > 0.5 && r.saturation > 0.8 && ratio > 0.35)
    out.reasons.push_back("large spin: on the parabolic bound the force is up to 46 % too large");
  if (against > most_hidden)
    out.reasons.push_back(
        "spin against lateral creepage: their forces cancel, and what is left is up to 0.26 mu N off");
  if (!parabolic && crossed > most_hidden)
    out.reasons.push_back("spin beside longitudinal creepage: on the elliptic bound up to 0.12 mu N off");
  if (in.cells.nx < 10 && in.patch.is_ellipse)
    out.reasons.push_back("coarse grid: fewer than 10 cells along the patch");
  check_ellipse(in, k, out);
  return out;
}
TangentialOutcome solve_fastsim(const TangentialInput& in) { return fastsim_on(in, Bound::parabolic); }
TangentialOutcome solve_fastsim_elliptic(const TangentialInput& in) { return fastsim_on(in, Bound::elliptic); }

/// Carter's problem (1926): a line contact is one strip, and half-planes stand for the half-spaces.
TangentialOutcome solve_line(const TangentialInput& in) {
  TangentialOutcome out;
  const RollingCase c = case_of(in);
  const StripPatch patch = strips_of(in, Bound::elliptic);
  const StripSolution line = strip_theory(patch, c, in.store);
  out.force = line.force;
  out.stick_share = line.stick_share;
  if (in.store) out.map = map_of_strips(patch, line);
  out.error_estimate = 0.25 / static_cast<double>(patch.cells());
  if (c.creepage.spin != 0.0) out.reasons.push_back("spin of a line contact is not plane");
  check_materials(in, out);
  return out;
}

/// Theory of a strip's tractions: plane rolling, or Kalker's stiffness with FASTSIM's slip directions.
enum class StripLaw { plane, fastrip };

TangentialOutcome strips_on(const TangentialInput& in, StripLaw law) {
  const bool is_fastrip = law == StripLaw::fastrip;
  if (!is_fastrip && in.patch.is_line) return solve_line(in);
  TangentialOutcome out;
  const auto [c, k, r] = prepared(in);
  const StripPatch patch = strips_of(in, Bound::elliptic);
  RollingCase cells = c;
  cells.creepage = creepage_of_cells(in);
  const StripSolution s = is_fastrip ? fastrip(patch, cells, k, in.store) : strip_theory(patch, cells, in.store);
  out.force = s.force;
  out.stick_share = s.stick_share;
  if (in.store) out.map = map_of_strips(patch, s);
  const double ratio = c.ellipse.a / c.ellipse.b, spin = std::min(1.0, r.saturation * r.saturation) * r.spin_share;
  if (is_fastrip) {
    const double against = 0.1 * r.against * r.against * std::min(1.0, 0.25 * r.saturation * r.saturation),
                 crossed = r.crossed * (0.06 + 0.05 / ratio) * std::min(1.0, r.saturation / 1.5);
    out.error_estimate = std::min(0.025, 0.1 * r.saturation) + 0.03 * spin + against + crossed + grid_error(in);
    if (crossed > 0.08)
      out.reasons.push_back(
          "spin beside longitudinal creepage on a patch that is short along the track: up to 0.11 mu N off");
  } else {
    out.error_estimate = std::min(1.0, 0.2 * ratio) * std::min(1.0, r.saturation) + 0.4 * spin;
    if (ratio > 0.2 || r.spin_share > 0.1)
      out.reasons.push_back(
          "strips are plane only where the patch is slender across the track and spin is small: up to 25 % off on a "
          "circle, 40 % with spin");
  }
  check_ellipse(in, k, out);
  return out;
}
TangentialOutcome solve_strip(const TangentialInput& in) { return strips_on(in, StripLaw::plane); }
TangentialOutcome solve_fastrip(const TangentialInput& in) { return strips_on(in, StripLaw::fastrip); }

/// A line contact is possible in steady rolling only: a shift of half-planes has no finite displacement at infinity to
/// refer to.
TangentialOutcome solve_half_space_rolling(const TangentialInput& in) {
  if (!in.patch.is_line) return steady_half_space(in, saturation_of(in));
  return solve_line(in);
}
template <TangentialOutcome (*Model)(const TangentialInput&)>
TangentialOutcome not_on_lines(const TangentialInput& in) {
  TangentialOutcome out = Model(in);
  if (in.patch.is_line)
    out.reasons.push_back("a line contact: half-planes yield without bound, the ellipse of the same axes was taken");
  return out;
}

/// The model, with results derived from its force.
template <TangentialOutcome (*Model)(const TangentialInput&)>
TangentialOutcome complete(const TangentialInput& in) {
  TangentialOutcome out = Model(in);
  if (in.patch.is_line && in.patch.runs_along)
    out.reasons.push_back("a line contact along the track rolls along its own line, which is not plane");
  out.wear_number = dissipation(out.force, case_of(in).creepage);
  return out;
}

}  // namespace

const std::vector<TangentialModel>& all_tangential_models() {
  static const std::vector<TangentialModel> all{
      {{"kalker-linear", "no slip anywhere; vanishing creepage", {}, {}, "Kalker 1967"}, complete<solve_kalker_linear>},
      {{"vermeulen-johnson", "elliptic stick zone at the leading edge; no spin", {}, {}, "Vermeulen, Johnson 1964"},
       complete<solve_vermeulen_johnson>},
      {{"shen-hedrick-elkins",
        "Kalker's linear force, saturated by a cubic; small spin",
        {},
        {},
        "Shen, Hedrick, Elkins 1983"},
       complete<solve_she>},
      {{"polach", "closed form for large creepage, kA = kS = 1", {}, {}, "Polach 1999, 2005"}, complete<solve_polach>},
      {{"coulomb", "full slip against the rigid creepage", {}, {}, "Coulomb 1785"}, complete<solve_coulomb>},
      {{"fastsim", "bed of springs in strips, parabolic bound", {}, {}, "Kalker 1982"}, complete<solve_fastsim>},
      {{"fastsim-elliptic", "bed of springs in strips, elliptic bound", {}, {}, "Kalker 1982"},
       complete<solve_fastsim_elliptic>},
      {{"strip", "plane rolling contact strip by strip", {}, {}, "Haines, Ollerton 1963; Kalker 1967"},
       complete<solve_strip>},
      {{"fastrip",
        "strip theory with Kalker's stiffness and FASTSIM's slip directions",
        {},
        {},
        "Sichani, Enblom, Berg 2016"},
       complete<solve_fastrip>},
      {{"half-space", "boundary elements, extrapolated to the limit of fine grids", {}, {}, "Kalker 1990"},
       complete<solve_half_space_rolling>},
      {{"half-space-start", "the same, rolling from rest over the case's distance", {}, {}, "Kalker 1990"},
       complete<not_on_lines<starting_half_space>>,
       false},
      {{"half-space-shift", "the same, shifted by creepage times distance without rolling", {}, {}, "Cattaneo 1938"},
       complete<not_on_lines<shifted_half_space>>,
       false}};
  return all;
}

}  // namespace epafi
