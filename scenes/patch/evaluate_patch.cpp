#include "scenes/patch/evaluate_patch.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>

#include <fmt/core.h>

#include "detection/surfaces/surface_gap.h"
#include "laws/wheel_rail/normal/strip_influence.h"
#include "laws/wheel_rail/normal_models.h"

namespace epafi {
namespace {

using std::numbers::pi;

/// Profiles meet to 1e-12 m, what doubles hold of heights of half a metre: below this [m] the gaps of a patch are
/// noise.
constexpr double least_approach = 1e-9;

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// h = A x^2 + B y^2.
class QuadraticGap final : public GapSource {
 public:
  QuadraticGap(double A, double B, double y1, double y2) : A_(A), B_(B), y1_(y1), y2_(y2) {}
  std::vector<ContactRegion> regions() const override {
    ContactRegion r;
    r.curvature_x = 2.0 * A_, r.curvature_y = 2.0 * B_;
    r.wheel_curvature = 1.0 / y1_, r.rail_curvature = 1.0 / y2_;
    return {r};
  }
  ContactRegion moved(const ContactRegion& region, double, double) const override { return region; }
  double angle_at(const ContactRegion&, double) const override { return 0.0; }
  GapField field(const ContactRegion&, double cx, double cy, double dx, double dy, std::size_t nx,
                 std::size_t ny) const override {
    GapField f;
    f.dx = dx, f.dy = dy, f.nx = nx, f.ny = ny;
    f.curvature_x = 2.0 * A_, f.curvature_y = 2.0 * B_;
    f.gap.resize(nx * ny);
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) {
        const double x = cx + f.x(i), y = cy + f.y(j);
        f.gap[j * nx + i] = A_ * x * x + B_ * y * y;
      }
    }
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

template <class List>
const typename List::value_type& model_named(const List& list, const std::string& name) {
  return *std::find_if(list.begin(), list.end(), [&](const auto& m) { return m.entry.name == name; });
}

/// Geometry of the case, found once, and its normal contact by any model; a line contact and a given ellipse are Hertz
/// whatever the name.
struct NormalSolver {
  const PatchCase& c;
  std::unique_ptr<GapSource> source;
  std::vector<ContactRegion> rigid;   ///< at the rigid contact points
  std::vector<ContactRegion> seated;  ///< the deepest one at the middle of the patch
  double approach = 0.0;              ///< estimated [m]
  double depth = 0.0, lowered = 0.0;  ///< that the load brings the wheel down by, and that it is brought down by [m]
  double sampled_at = 0.0;            ///< the same when the gaps of the seated region were sampled [m]
  double mean_radius = 0.0;           ///< speed over angular velocity of the wheelset [m]
  double seconds = 0.0;
  bool stresses = false;      ///< finite elements keep those inside the body
  mutable StripStart strips;  ///< of the last solution, for the next round on the same load
  bool rough = false;         ///< strips need not settle yet: the wheel will be seated anew

  explicit NormalSolver(const PatchCase& patch, bool keep_stresses = false) : c(patch), stresses(keep_stresses) {
    if (c.profiles) place_wheel(*c.profiles);
    if (!c.radii) return;
    const double A = 0.5 * (1.0 / c.radii->x1 + 1.0 / c.radii->x2), B = 0.5 * (1.0 / c.radii->y1 + 1.0 / c.radii->y2);
    if (A > 0.0 && B > 0.0) {
      source = std::make_unique<QuadraticGap>(A, B, c.radii->y1, c.radii->y2);
      rigid = seated = source->regions();
    }
  }

  void place_wheel(const ProfileCase& p) {
    auto owned = std::make_unique<WheelRailPair>(p.wheel, p.rail, p.track, p.right);
    strip_influence(1.0);  // tables of profiles and strips are made once, and no part of a case's time
    const double start = cpu_seconds();
    WheelRailPair& pair = *owned;
    source = std::move(owned);
    WheelsetPosition position = p.position;
    mean_radius = p.rolling_radius.value_or(0.0);
    if (!p.roll_given || !p.rolling_radius) {
      const WheelsetGeometry g = stand_on_rails(pair, position);
      if (!p.roll_given) position.roll = g.position.roll;
      if (!p.rolling_radius) mean_radius = 0.5 * (g.left.rolling_radius + g.right.rolling_radius);
    }
    constexpr double deepest = 1e-3;  // gap beyond which no model looks at any load of a railway
    pair.sample_profiles({0.2e-3, 16e-3, deepest});
    pair.place(position);
    pair.touch();
    rigid = pair.regions();
    if (rigid.empty()) return;
    const double N = c.target.by_force ? c.target.value / std::cos(rigid.front().angle) : c.target.value;
    depth = estimate(rigid, N, 0.0) / steepness(rigid.front());
    pair.lower(depth), pair.add_profile(rigid.front());
    seated = rigid, sampled_at = depth;
    for (int round = 0; round < 2; ++round) {  // as deep as its load brings it, in the plane of its own patch
      seat(depth);
      const double here = c.target.by_force ? c.target.value / std::cos(seated.front().angle) : c.target.value;
      const double last = depth * steepness(seated.front());
      approach = estimate(seated, here, last);
      depth = approach / steepness(seated.front());
      if (std::abs(approach - last) < 0.01 * last) break;  // the model itself brings it nearer, if it can
    }
    seat(depth);
    seconds = cpu_seconds() - start;
  }

  /// Approach along the normal over the way down: held sideways, the wheel comes down along z and not along the normal.
  double steepness(const ContactRegion& r) const { return std::cos(r.angle); }

  /// The wheel `down` from where it touches, and the deepest region seen from the middle of its overlap there.
  void seat(double down) {
    // lowered along z it also moves along the plane: gaps sampled at another depth hold until that is 1e-3 of 20 um
    constexpr double sideways = 2e-8;
    WheelRailPair& pair = static_cast<WheelRailPair&>(*source);
    ContactRegion& r = seated.front();
    pair.lower(down), lowered = down;
    if (std::abs((down - sampled_at) * std::sin(r.angle)) > sideways) pair.add_profile(r), sampled_at = down;
    const PatchPlace at = place_of_patch(pair, r, down * steepness(r));
    if (std::abs(at.y) > 2e-6 || std::abs(at.angle - r.angle) > 1e-5)
      r = pair.moved(r, at.y, at.angle), sampled_at = down;
  }

  /// Whether the wheel stands as deep as a model has found; only those of the whole gap can tell.
  bool stands(const std::string& model, double found) const {
    if (!model_named(all_normal_models(), model).whole_gap || !(found > 0.0)) return true;
    return std::abs(found / steepness(seated.front()) - lowered) < 1e-3 * lowered;
  }

  /// Seats the wheel anew at this approach.
  void follow(double expected) { seat(expected / steepness(seated.front())), approach = expected; }

  double estimate(const std::vector<ContactRegion>& regions, double value, double known) const {
    NormalInput in{*source, regions, c.elastic, {c.target.by_force, value}};
    in.influence = c.influence, in.approach = known, in.start = &strips;
    return estimate_approach(in);
  }

  bool too_shallow() const { return c.profiles && !rigid.empty() && !(approach >= least_approach); }

  /// Regions a model works on.
  const std::vector<ContactRegion>& regions(const std::string& model) const {
    return model_named(all_normal_models(), model).whole_gap ? seated : rigid;
  }

  /// Where its patches lie: creepages are those of there.
  const std::vector<ContactRegion>& places(const std::string& model) const {
    const NormalModel& m = model_named(all_normal_models(), model);
    return m.whole_gap || m.strips ? seated : rigid;
  }

  std::vector<RegionPatch> solve(const std::string& model, const NormalTarget& target) const {
    const double E = c.elastic.effective_modulus();
    if (c.ellipse) {
      RegionPatch p{0, patch_of_hertz(hertz_of_ellipse(*c.ellipse, E, target.value))};
      if (model != "hertz")
        p.patch.reasons.push_back("a given ellipse has Hertz' pressure; model '" + model + "' was not run");
      return {p};
    }
    if (c.profiles && rigid.empty()) {
      RegionPatch none;
      none.patch.reasons.push_back("wheel and rail do not meet at this place of the wheelset");
      return {none};
    }
    if (too_shallow()) {
      RegionPatch none;
      none.patch.reasons.push_back(fmt::format(
          "an approach of {:.3g} m is below {:.0e} m, the least that profiles tell from their own rounding; "
          "give a larger load or approach, or radii",
          approach, least_approach));
      return {none};
    }
    if (!source) return {line(model, target)};
    NormalInput in{*source, regions(model), c.elastic, target, c.dx, c.dy, approach};
    in.start = &strips;
    in.settle = rough ? 0.02 : 3e-3;
    in.stresses = stresses, in.influence = c.influence, in.penalty = c.penalty;
    return model_named(all_normal_models(), model).solve(in);
  }

  RegionPatch line(const std::string& model, const NormalTarget& target) const {
    const double A = 0.5 * (1.0 / c.radii->x1 + 1.0 / c.radii->x2), B = 0.5 * (1.0 / c.radii->y1 + 1.0 / c.radii->y2);
    const LineContact l = hertz_line(std::max(A, B), c.elastic.effective_modulus(), target.value / *c.length);
    RegionPatch out;
    NormalPatch& p = out.patch;
    p.is_line = true;
    p.ellipse = A > 0.0 ? Ellipse{l.half_width, 0.5 * *c.length} : Ellipse{0.5 * *c.length, l.half_width};
    p.normal_force = target.value, p.max_pressure = l.max_pressure, p.area = 2.0 * l.half_width * *c.length;
    if (model != "hertz")
      p.reasons.push_back("a line contact is Hertz' plane solution; model '" + model + "' was not run");
    return out;
  }

  /// Creepage at the middle of a patch: as given, or of the rigid wheelset rolling with its speed over its angular
  /// velocity. The point of the wheel moves with V e_x + omega x r, omega = -(V / mean_radius) along the axle; the rail
  /// stands still.
  Creepage creepage(const ContactRegion& r) const {
    if (!c.profiles || c.profiles->creepage_given) return c.creepage;
    const ProfileCase& p = *c.profiles;
    const double yaw = p.position.yaw, w = 1.0 / mean_radius;
    const Vec3 axle(-std::sin(yaw), std::cos(yaw), 0.0),
        centre(0.0, p.position.lateral_shift, r.point.z() - r.rolling_radius);
    const Vec3 velocity = Vec3::UnitX() - w * axle.cross(r.point - centre);
    const Vec3 t(0.0, std::cos(r.angle), std::sin(r.angle)), n(0.0, -t.z(), t.y());
    return {-velocity.x(), -velocity.dot(t), w * axle.dot(n)};
  }
};

/// Cells over an elliptic patch: those given, else 32 square ones along the shorter axis (at most 256 along the
/// longer).
PatchGrid cells_of(const PatchCase& c, const Ellipse& e) {
  const double shorter = 2.0 * std::min(e.a, e.b) / 32.0;
  const auto count = [](double length, double cell, std::size_t most) {  // multiples of 4: two coarser grids exist
    return std::clamp<std::size_t>((static_cast<std::size_t>(std::lround(length / cell)) + 2) / 4 * 4, 4, most);
  };
  PatchGrid g;
  g.nx = c.dx > 0.0 ? count(2.0 * e.a, c.dx, 4096) : count(2.0 * e.a, shorter, 256);
  g.ny = c.dy > 0.0 ? count(2.0 * e.b, c.dy, 4096) : count(2.0 * e.b, shorter, 256);
  g.dx = 2.0 * e.a / static_cast<double>(g.nx), g.dy = 2.0 * e.b / static_cast<double>(g.ny);
  return g;
}

void add_reasons(std::vector<std::string>& to, const std::vector<std::string>& from) {
  for (const auto& r : from)
    if (std::find(to.begin(), to.end(), r) == to.end()) to.push_back(r);
}

/// Sums and peaks over the patches.
void add_normal(PatchResult& out, const RegionPatch& rp, const std::vector<ContactRegion>& regions) {
  const NormalPatch& p = rp.patch;
  PatchContact c;
  if (rp.region < regions.size()) {
    c.y_wheel = regions[rp.region].y_wheel, c.y_rail = regions[rp.region].y_rail, c.point = regions[rp.region].point,
    c.angle = regions[rp.region].angle;
  }
  c.semi_axes = p.ellipse, c.area = p.area, c.max_pressure = p.max_pressure, c.normal_force = p.normal_force;
  c.stress = p.stress;
  out.contacts.push_back(c);
  out.normal_force += p.normal_force, out.area += p.area;
  out.max_pressure = std::max(out.max_pressure, p.max_pressure), out.approach = std::max(out.approach, p.approach);
  out.error_estimate = std::max(out.error_estimate, p.error_estimate);
  add_reasons(out.reasons, p.reasons);
}

/// Patches of the left wheel are those of its mirror image: lateral quantities change their sign on the way in and out.
TangentialOutcome mirrored(TangentialOutcome t) {
  t.force.fy = -t.force.fy, t.force.mz = -t.force.mz;
  for (auto* column : {&t.map.y, &t.map.traction_y, &t.map.slip_y})
    for (double& v : *column) v = -v;
  return t;
}

void add_tangential(PatchResult& out, const PatchCase& c, const Creepage& creepage, const RegionPatch& rp,
                    const TangentialModel& model, bool maps) {
  const bool left = c.profiles && !c.profiles->right;
  const Creepage seen = left ? Creepage{creepage.longitudinal, -creepage.lateral, -creepage.spin} : creepage;
  TangentialOutcome t =
      model.solve({rp.patch, c.elastic, c.friction, seen, cells_of(c, rp.patch.ellipse), maps, c.distance});
  if (left) t = mirrored(std::move(t));
  PatchContact& contact = out.contacts.back();
  contact.force = t.force;
  contact.map = t.map;
  out.force.fx += t.force.fx, out.force.fy += t.force.fy, out.force.mz += t.force.mz;
  out.wear_number += t.wear_number;
  // stick by area over all patches; unknown if one does not know
  const double share = rp.patch.area * t.stick_share;
  if (t.stick_share < 0.0)
    out.stick_share = -1.0;
  else
    out.stick_share = (std::max(0.0, out.stick_share) * (out.area - rp.patch.area) + share) / out.area;
  out.error_estimate = std::max(out.error_estimate, t.error_estimate);
  add_reasons(out.reasons, t.reasons);
}

void add_damage(PatchResult& out, const PatchCase& c) {
  if (!c.yield || out.contacts.empty() || !(out.normal_force > 0.0)) return;
  const PatchContact& worst =
      *std::max_element(out.contacts.begin(), out.contacts.end(),
                        [](const auto& a, const auto& b) { return a.max_pressure < b.max_pressure; });
  out.pressure_over_yield = worst.max_pressure / *c.yield;
  const double used = std::hypot(worst.force.fx, worst.force.fy) / worst.normal_force;
  out.fatigue_index = used - 2.0 * pi * worst.semi_axes.a * worst.semi_axes.b * *c.yield / (3.0 * worst.normal_force);
  // elastic shakedown of a frictionless line contact ends at p0 = 4 k (Johnson 1989)
  if (*out.pressure_over_yield > 4.0)
    out.reasons.push_back(
        "plastic pressure: p0 is more than 4 times the shear yield stress, the elastic solution does not last");
}

/// One pair of models under a normal force or approach.
PatchResult evaluate_pair(const PatchCase& c, const NormalSolver& solver, const std::string& normal,
                          const std::string& tangential, const std::vector<RegionPatch>& patches, bool maps) {
  PatchResult out;
  out.normal = normal, out.tangential = tangential, out.friction = !tangential.empty();
  const auto& regions = solver.places(normal);
  for (const RegionPatch& rp : patches) {
    add_normal(out, rp, regions);
    if (tangential.empty() || !(rp.patch.normal_force > 0.0)) continue;
    const Creepage creepage = rp.region < regions.size() ? solver.creepage(regions[rp.region]) : c.creepage;
    add_tangential(out, c, creepage, rp, model_named(all_tangential_models(), tangential), maps);
  }
  if (!out.friction) out.stick_share = -1.0;
  return out;
}

/// Vertical force of the contacts [N].
double vertical_force(const PatchResult& r) {
  double sum = 0.0;
  for (const PatchContact& k : r.contacts) sum += k.normal_force * std::cos(k.angle) + k.force.fy * std::sin(k.angle);
  return sum;
}

/// With profiles the load is vertical: the normal force follows from the inclination of the contact and from friction,
/// and with it how deep the wheel stands, which moves load between regions beside each other.
PatchResult meet_load(const PatchCase& c, NormalSolver& solver, const std::string& normal,
                      const std::string& tangential, bool maps) {
  NormalTarget target = c.target;
  if (solver.lowered != solver.depth) solver.seat(solver.depth);
  const bool inclined = c.profiles && target.by_force && !solver.rigid.empty() && !solver.too_shallow();
  if (inclined) target.value /= std::cos(solver.places(normal).front().angle);
  solver.rough = inclined;
  PatchResult out = evaluate_pair(c, solver, normal, tangential, solver.solve(normal, target), maps);
  if (!inclined) return out;
  const bool strips = normal == "semi-hertz";
  const double near = strips ? 3e-4 : 1e-4;  // strips settle to as much; the peak pressure feels a third of it
  for (int k = 0; k < 12; ++k) {
    const double vertical = vertical_force(out), ratio = std::clamp(c.target.value / vertical, 0.5, 2.0);
    const bool met = std::abs(vertical - c.target.value) < near * c.target.value;
    if (met && solver.stands(normal, out.approach) && !(strips && solver.rough)) return out;
    solver.rough = false;
    // creep forces grow nearly as the normal force, the approach as its root (its 2/3 power for one ellipse)
    target.value *= ratio;
    const double expected = out.approach * std::sqrt(ratio);
    if (!solver.stands(normal, expected)) solver.follow(expected);
    out = evaluate_pair(c, solver, normal, tangential, solver.solve(normal, target), maps);
  }
  const double missed = vertical_force(out) - c.target.value;
  if (std::abs(missed) > 1e-3 * c.target.value)
    out.reasons.push_back("the vertical force misses the load by " + std::to_string(missed) + " N after 12 rounds");
  return out;
}

}  // namespace

std::vector<PatchResult> evaluate_patch(const PatchCase& c, bool maps) {
  NormalSolver solver(c, maps);
  std::vector<PatchResult> all;
  for (const std::string& normal : c.normal) {
    std::vector<std::string> tangential = c.tangential;
    if (tangential.empty()) tangential.push_back("");
    for (const std::string& name : tangential) {
      const double begin = cpu_seconds();
      PatchResult out = meet_load(c, solver, normal, name, maps);
      add_damage(out, c);
      out.milliseconds = 1e3 * (solver.seconds + cpu_seconds() - begin);
      all.push_back(std::move(out));
    }
  }
  return all;
}

}  // namespace epafi
