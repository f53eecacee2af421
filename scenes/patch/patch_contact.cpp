#include "scenes/patch/patch_contact.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "detection/surfaces/surface_gap.h"
#include "laws/wheel_rail/normal/strip_influence.h"

namespace epafi {
namespace {

/// Contact of profiles is found to 1e-12 m, the rounding error of heights of 0.5 m: below this approach [m] gaps are
/// noise.
constexpr double least_approach = 1e-9;

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// h = A x^2 + B y^2.
class QuadraticGap final : public GapSource {
 public:
  QuadraticGap(double A, double B, double y1, double y2) : A_(A), B_(B), y1_(y1), y2_(y2) {}
  std::vector<ContactRegion> regions() const override {
    ContactRegion r;
    r.curvature_x = 2.0 * A_;
    r.curvature_y = 2.0 * B_;
    r.wheel_curvature = 1.0 / y1_;
    r.rail_curvature = 1.0 / y2_;
    return {r};
  }
  ContactRegion moved(const ContactRegion& region, double, double) const override { return region; }
  double angle_at(const ContactRegion&, double) const override { return 0.0; }
  GapField field(const ContactRegion&, double cx, double cy, double dx, double dy, std::size_t nx,
                 std::size_t ny) const override {
    GapField f = GapField::of(cx, cy, dx, dy, nx, ny, [&](double x, double y) { return A_ * x * x + B_ * y * y; });
    f.curvature_x = 2.0 * A_;
    f.curvature_y = 2.0 * B_;
    return f;
  }
  std::unique_ptr<GapOperator> gaps_between(GapMethod method, std::span<const Vec3> nodes,
                                            std::span<const Triangle> first, std::span<const Triangle> second,
                                            double band) const override {
    return make_gap_operator(method, nodes, first, second, band);
  }

 private:
  double A_, B_, y1_, y2_;
};

/// Text why a wheel on this rail has no contact; empty where it has one.
std::string missing_contact(const WheelRailPair& pair, const ProfileCase& p, double shift) {
  switch (pair.missing()) {
    case WheelRailPair::Missing::nothing:
      return "";
    case WheelRailPair::Missing::apart:
      return fmt::format(
          "wheel and rail do not lie above each other: lateral_shift = {:.4g} m, gauge = {:.4g} m, flange_back = "
          "{:.4g} m, tape_circle = {:.4g} m; is one of them in another unit?",
          shift, p.track.gauge, p.track.flange_back, p.track.tape_circle);
    case WheelRailPair::Missing::wheel_ends:
      return fmt::format(
          "the wheel touches first with an end of its profile (points from y = {:.4g} to {:.4g} m): are they cut too "
          "short, or y mirrored?",
          p.wheel.y_min(), p.wheel.y_max());
    case WheelRailPair::Missing::rail_ends:
      return fmt::format(
          "the wheel touches first beside the rail's points (from y = {:.4g} to {:.4g} m): are they cut too short, z "
          "upside down, or y mirrored?",
          p.rail.y_min(), p.rail.y_max());
  }
  return "";
}

/// The same for a wheelset on both rails.
std::string missing_stand(const WheelRailPair& side, const ProfileCase& p) {
  for (const bool right : {false, true}) {
    WheelRailPair pair = side.on_side(right);
    pair.place(p.position);
    std::string text = missing_contact(pair, p, p.position.lateral_shift);
    if (!text.empty()) return text + (right ? " (right wheel)" : " (left wheel)");
  }
  return fmt::format(
      "the wheelset does not stand on both rails with its axle's middle {:.4g} m beside the track's: before it is "
      "there, the flange runs up; write a smaller lateral_shift, or roll for one wheel alone",
      p.position.lateral_shift);
}

}  // namespace

const NormalModel& normal_model(const std::string& name) {
  const auto& all = all_normal_models();
  return *std::find_if(all.begin(), all.end(), [&](const NormalModel& m) { return m.entry.name == name; });
}

PatchContactSolver::PatchContactSolver(const PatchCase& patch, bool keep_stresses)
    : c_(patch), stresses_(keep_stresses) {
  if (c_.profiles) place_wheel(*c_.profiles);
  if (!c_.radii) return;
  const double A = 0.5 * (1.0 / c_.radii->x1 + 1.0 / c_.radii->x2), B = 0.5 * (1.0 / c_.radii->y1 + 1.0 / c_.radii->y2);
  if (A > 0.0 && B > 0.0) {
    quadratic_ = std::make_unique<QuadraticGap>(A, B, c_.radii->y1, c_.radii->y2);
    regions_ = quadratic_->regions();
  }
}

void PatchContactSolver::place_wheel(const ProfileCase& p) {
  const WheelRailPair pair(p.wheel, p.rail, p.track, p.right);
  strip_influence(1.0);  // tables of profiles and strips are made once, and no part of a case's time
  const double start = processor_seconds();
  reasons = p.doubts;
  WheelsetPosition position = p.position;
  if (!p.roll_given) {
    const WheelsetGeometry g = stand_on_rails(pair, position);
    if (!g.stands) {
      missing_ = missing_stand(pair, p);
      return;
    }
    position.roll = g.position.roll;
  }
  wheel_.emplace(pair, c_.elastic, c_.influence);
  wheel_->place(position);
  if (wheel_->rigid.empty()) {
    missing_ = missing_contact(wheel_->pair, p, position.lateral_shift);
    return;
  }
  wheel_->settle(c_.target);
  mean_radius_ = p.rolling_radius.value_or(0.0);
  if (!p.rolling_radius && !p.creepage_given && !c_.tangential.empty() && !too_shallow())
    mean_radius_ = loaded_radius(p, position);
  seconds_ = processor_seconds() - start;
}

double PatchContactSolver::loaded_radius(const ProfileCase& p, const WheelsetPosition& position) {
  SeatedWheel other(wheel_->pair.on_side(!p.right), c_.elastic, c_.influence);
  other.place(position);
  const double here = wheel_->rolling_radius();
  if (other.rigid.empty()) {
    reasons.push_back(
        "the other wheel does not meet its rail; the wheelset is taken to roll as this wheel does: write "
        "rolling_radius");
    return here;
  }
  other.settle(c_.target);
  return 0.5 * (here + other.rolling_radius());
}

void PatchContactSolver::follow(double expected) {
  wheel_->seat(expected / SeatedWheel::steepness(wheel_->seated.front()));
  wheel_->approach = expected;
}

bool PatchContactSolver::stands(const std::string& model, double found) const {
  if (!normal_model(model).whole_gap || !(found > 0.0)) return true;
  const double lowered = wheel_->lowered, near = is_finite_elements(model) ? 1e-2 : 1e-3;  // they err by as much
  return std::abs(found / SeatedWheel::steepness(wheel_->seated.front()) - lowered) < near * lowered;
}

bool PatchContactSolver::too_shallow() const {
  return wheel_ && !wheel_->rigid.empty() && !(wheel_->approach >= least_approach);
}

const std::vector<ContactRegion>& PatchContactSolver::places(const std::string& model) const {
  if (!wheel_) return regions_;
  const NormalModel& m = normal_model(model);
  return m.whole_gap || m.strips ? wheel_->seated : wheel_->rigid;
}

RegionPatch PatchContactSolver::none() const {
  RegionPatch out;
  out.patch.reasons.push_back(missing_);
  return out;
}

NormalInput PatchContactSolver::input(const NormalModel& model, const NormalTarget& target) {
  const GapSource& source = wheel_ ? static_cast<const GapSource&>(wheel_->pair) : *quadratic_;
  const std::vector<ContactRegion>& on = !wheel_ ? regions_ : model.whole_gap ? wheel_->seated : wheel_->rigid;
  NormalInput in{source, on, c_.elastic, target, c_.dx, c_.dy, wheel_ ? wheel_->approach : 0.0};
  in.start = wheel_ ? &wheel_->strips.front() : &strips_.front();
  in.settle = rough ? 0.02 : 3e-3;
  in.stresses = stresses_;
  in.influence = c_.influence;
  in.penalty = c_.penalty;
  return in;
}

std::vector<RegionPatch> PatchContactSolver::solve(const std::string& model, const NormalTarget& target) {
  if (c_.ellipse) {
    RegionPatch p{0, patch_of_hertz(hertz_of_ellipse(*c_.ellipse, c_.elastic.effective_modulus(), target.value))};
    if (model != "hertz")
      p.patch.reasons.push_back("a given ellipse has Hertz' pressure; model '" + model + "' was not run");
    return {p};
  }
  if (!missing_.empty()) return {none()};
  if (too_shallow()) {
    RegionPatch p;
    p.patch.reasons.push_back(fmt::format(
        "an approach of {:.3g} m is less than {:.0e} m, below which the gaps of profiles are rounding errors; "
        "give a larger load or approach, or radii",
        wheel_->approach, least_approach));
    return {p};
  }
  if (!wheel_ && !quadratic_) return {line(model, target)};
  const NormalModel& m = normal_model(model);
  return is_finite_elements(model) ? remembered(m, target) : m.solve(input(m, target));
}

std::vector<RegionPatch> PatchContactSolver::remembered(const NormalModel& m, const NormalTarget& target) {
  const double lowered = wheel_ ? wheel_->lowered : 0.0, approach = wheel_ ? wheel_->approach : 0.0;
  const auto known = std::ranges::find_if(known_, [&](const Known& k) {
    return k.model == m.entry.name && k.target == target.value && k.lowered == lowered && k.approach == approach;
  });
  if (known != known_.end()) {
    remembered_seconds_ += known->seconds;
    return known->patches;
  }
  const double start = processor_seconds();
  known_.push_back({m.entry.name, target.value, lowered, approach, m.solve(input(m, target)), 0.0});
  known_.back().seconds = processor_seconds() - start;
  return known_.back().patches;
}

std::vector<RegionPatch> PatchContactSolver::solve_apart(const std::string& model) {
  const NormalModel& m = normal_model(model);
  return wheel_->solve(m, input(m, {}));
}

RegionPatch PatchContactSolver::line(const std::string& model, const NormalTarget& target) const {
  const double A = 0.5 * (1.0 / c_.radii->x1 + 1.0 / c_.radii->x2), B = 0.5 * (1.0 / c_.radii->y1 + 1.0 / c_.radii->y2);
  const LineContact l = hertz_line(std::max(A, B), c_.elastic.effective_modulus(), target.value / *c_.length);
  RegionPatch out;
  NormalPatch& p = out.patch;
  p.is_line = true;
  p.runs_along = !(A > 0.0);
  p.ellipse = A > 0.0 ? Ellipse{l.half_width, 0.5 * *c_.length} : Ellipse{0.5 * *c_.length, l.half_width};
  p.normal_force = target.value;
  p.max_pressure = l.max_pressure;
  p.area = 2.0 * l.half_width * *c_.length;
  if (model != "hertz")
    p.reasons.push_back("a line contact is Hertz' plane solution; model '" + model + "' was not run");
  return out;
}

SlipBesidePlane PatchContactSolver::slip_beside_plane(const ContactRegion& region, const NormalPatch& patch) const {
  SlipBesidePlane out;
  if (!has_wheel() || c_.profiles->creepage_given) return out;
  const Creepage plane = creepage(region);
  const double spin = c_.profiles->right ? plane.spin : -plane.spin;
  const bool ellipse = patch.pressure.empty();
  const double middle = ellipse ? patch.centre_y : patch.grid_y;
  const double half = ellipse ? patch.ellipse.b : 0.5 * patch.grid.dy * static_cast<double>(patch.grid.ny);
  constexpr int steps = 24;  // over a patch of two hills: the surface between them is one bend
  out.first = -half;
  out.step = 2.0 * half / steps;
  for (int k = 0; k <= steps; ++k) {
    const double y = middle + out.first + k * out.step;
    const ContactRegion there = wheel_->pair.place_at(region, y, wheel_->pair.angle_at(region, y));
    const double slip = creepage(there).longitudinal - (plane.longitudinal - spin * y);
    out.value.push_back(std::isfinite(slip) ? slip : 0.0);
  }
  return out;
}

Creepage PatchContactSolver::creepage(const ContactRegion& r) const {
  if (!c_.profiles || c_.profiles->creepage_given) return c_.creepage;
  // the point of the wheel moves with V e_x + omega x r, omega = -(V / mean_radius) along the axle; the rail is at rest
  const ProfileCase& p = *c_.profiles;
  const double yaw = p.position.yaw, w = 1.0 / mean_radius_;
  const Vec3 axle(-std::sin(yaw), std::cos(yaw), 0.0),
      centre(0.0, p.position.lateral_shift, r.point.z() - r.rolling_radius);
  const Vec3 velocity = Vec3::UnitX() - w * axle.cross(r.point - centre);
  const Vec3 t(0.0, std::cos(r.angle), std::sin(r.angle)), n(0.0, -t.z(), t.y());
  return {-velocity.x(), -velocity.dot(t), w * axle.dot(n)};
}

}  // namespace epafi
