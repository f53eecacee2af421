#include "scenes/patch/evaluate_patch.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>

#include <fmt/core.h>

#include "laws/wheel_rail/normal_models.h"
#include "laws/wheel_rail/tangential/polach.h"
#include "scenes/patch/patch_contact.h"

namespace epafi {
namespace {

using std::numbers::pi;

constexpr double most_by_plane = 1.0 / 3.0;  // of mu N: beyond it the force says little

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

const TangentialModel& tangential_model(const std::string& name) {
  const auto& all = all_tangential_models();
  return *std::find_if(all.begin(), all.end(), [&](const TangentialModel& m) { return m.entry.name == name; });
}

/// Grid over an elliptic patch: cells of the case, else 32 square ones along the shorter axis (at most 256 along the
/// longer).
PatchGrid cells_of(const PatchCase& c, const Ellipse& e) {
  const double shorter = 2.0 * std::min(e.a, e.b) / 32.0;
  const auto count = [](double length, double cell, std::size_t most) {  // multiples of 4: two coarser grids exist
    return std::clamp<std::size_t>((static_cast<std::size_t>(std::lround(length / cell)) + 2) / 4 * 4, 4, most);
  };
  PatchGrid g;
  g.nx = c.dx > 0.0 ? count(2.0 * e.a, c.dx, 4096) : count(2.0 * e.a, shorter, 256);
  g.ny = c.dy > 0.0 ? count(2.0 * e.b, c.dy, 4096) : count(2.0 * e.b, shorter, 256);
  g.dx = 2.0 * e.a / static_cast<double>(g.nx);
  g.dy = 2.0 * e.b / static_cast<double>(g.ny);
  return g;
}

/// Adds reasons that `to` does not contain yet.
void add_reasons(std::vector<std::string>& to, const std::vector<std::string>& from) {
  for (const auto& r : from)
    if (std::find(to.begin(), to.end(), r) == to.end()) to.push_back(r);
}

/// Updates sums and peaks over the patches.
void add_normal(PatchResult& out, const RegionPatch& rp, const std::vector<ContactRegion>& regions) {
  const NormalPatch& p = rp.patch;
  PatchContact c;
  if (rp.region < regions.size()) {
    c.y_wheel = regions[rp.region].y_wheel;
    c.y_rail = regions[rp.region].y_rail;
    c.point = regions[rp.region].point;
    c.angle = regions[rp.region].angle;
  }
  c.semi_axes = p.ellipse;
  c.area = p.area;
  c.max_pressure = p.max_pressure;
  c.normal_force = p.normal_force;
  c.stress = p.stress;
  out.contacts.push_back(c);
  out.normal_force += p.normal_force;
  out.area += p.area;
  out.max_pressure = std::max(out.max_pressure, p.max_pressure);
  out.approach = std::max(out.approach, p.approach);
  out.error_estimate = std::max(out.error_estimate, p.error_estimate);
  add_reasons(out.reasons, p.reasons);
  add_reasons(out.notes, p.notes);
}

/// Reports contacts on the linear extrapolation beyond the points of a profile.
void check_ends(const ProfileCase& p, PatchResult& out) {
  for (const PatchContact& k : out.contacts) {
    if (!(k.normal_force > 0.0)) continue;
    const double half = k.semi_axes.b * std::cos(k.angle);
    const auto beyond = [&](const Profile& profile, double y) {
      return y - half < profile.y_min() || y + half > profile.y_max();
    };
    if (beyond(p.rail, k.y_rail)) add_reasons(out.reasons, {"the contact reaches an end of the rail's points"});
    if (beyond(p.wheel, k.y_wheel)) add_reasons(out.reasons, {"the contact reaches an end of the wheel's points"});
  }
}

/// The left wheel is solved as its mirror image: lateral quantities change sign in input and output.
TangentialOutcome mirrored(TangentialOutcome t) {
  t.force.fy = -t.force.fy;
  t.force.mz = -t.force.mz;
  for (auto* column : {&t.map.y, &t.map.traction_y, &t.map.slip_y})
    for (double& v : *column) v = -v;
  return t;
}

void add_tangential(PatchResult& out, const PatchCase& c, const Creepage& creepage, const RegionPatch& rp,
                    const TangentialModel& model, bool maps, const SlipBesidePlane& beside_plane) {
  const bool left = c.profiles && !c.profiles->right;
  const Creepage seen = left ? Creepage{creepage.longitudinal, -creepage.lateral, -creepage.spin} : creepage;
  const double slip = c.falling.speed * std::hypot(seen.longitudinal, seen.lateral);
  const double friction = falling_friction(c.friction, c.falling.limit, c.falling.decay, slip);
  const TangentialInput in{rp.patch, c.elastic, friction, seen, cells_of(c, rp.patch.ellipse), maps, c.distance};
  TangentialOutcome t = model.solve(in);
  if (left) t = mirrored(std::move(t));
  PatchContact& contact = out.contacts.back();
  contact.force = t.force;
  contact.map = t.map;
  out.force.fx += t.force.fx;
  out.force.fy += t.force.fy;
  out.force.mz += t.force.mz;
  out.wear_number += t.wear_number;
  // stick share weighted by area over all patches; unknown if it is for one
  const double share = rp.patch.area * t.stick_share;
  if (t.stick_share < 0.0)
    out.stick_share = -1.0;
  else
    out.stick_share = (std::max(0.0, out.stick_share) * (out.area - rp.patch.area) + share) / out.area;
  const double by_plane = force_beside_plane(in, beside_plane);
  out.error_estimate = std::max(out.error_estimate, t.error_estimate + by_plane);
  if (by_plane > most_by_plane)
    out.reasons.push_back(fmt::format(
        "the surface leaves its plane, whose slip is taken for the patch: forces are up to {:.2g} mu N off", by_plane));
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
PatchResult evaluate_pair(const PatchCase& c, const PatchContactSolver& solver, const std::string& normal,
                          const std::string& tangential, const std::vector<RegionPatch>& patches, bool maps) {
  PatchResult out;
  out.normal = normal;
  out.tangential = tangential;
  out.friction = !tangential.empty();
  const auto& regions = solver.places(normal);
  for (const RegionPatch& rp : patches) {
    add_normal(out, rp, regions);
    if (tangential.empty() || !(rp.patch.normal_force > 0.0)) continue;
    const bool known = rp.region < regions.size();
    const Creepage creepage = known ? solver.creepage(regions[rp.region]) : c.creepage;
    const SlipBesidePlane beside_plane =
        known ? solver.slip_beside_plane(regions[rp.region], rp.patch) : SlipBesidePlane{};
    add_tangential(out, c, creepage, rp, tangential_model(tangential), maps, beside_plane);
  }
  if (!out.friction) out.stick_share = -1.0;
  if (c.profiles) check_ends(*c.profiles, out);
  add_reasons(out.reasons, solver.reasons);
  return out;
}

/// Vertical force of the contacts [N].
double vertical_force(const PatchResult& r) {
  double sum = 0.0;
  for (const PatchContact& k : r.contacts) sum += k.normal_force * std::cos(k.angle) + k.force.fy * std::sin(k.angle);
  return sum;
}

constexpr int most_rounds = 12;

void add_missed_load(const PatchCase& c, PatchResult& out) {
  const double missed = vertical_force(out) - c.target.value;
  if (!(std::abs(missed) <= 1e-3 * c.target.value))
    out.reasons.push_back(
        fmt::format("the vertical force misses the load by {:.4g} N after {} rounds", missed, most_rounds));
}

/// With profiles the load is vertical: the normal force follows from the inclination of the contact and from friction,
/// and with it the vertical position of the wheel, which shifts load between adjacent regions.
PatchResult meet_load_on_one(const PatchCase& c, PatchContactSolver& solver, const std::string& normal,
                             const std::string& tangential, bool maps) {
  NormalTarget target = c.target;
  const bool inclined = solver.has_wheel() && target.by_force;
  if (solver.has_wheel() && solver.lowered() != solver.depth()) solver.seat(solver.depth());
  if (inclined) target.value /= std::cos(solver.places(normal).front().angle);
  solver.rough = inclined;
  PatchResult out = evaluate_pair(c, solver, normal, tangential, solver.solve(normal, target), maps);
  if (!inclined) return out;
  const bool strips = normal == "semi-hertz";
  // strips converge to this; the relative error of the peak pressure is a third of it
  const double near = strips ? 3e-4 : is_finite_elements(normal) ? 1e-3 : 1e-4;
  for (int k = 0; k < most_rounds; ++k) {
    const double vertical = vertical_force(out), ratio = std::clamp(c.target.value / vertical, 0.5, 2.0);
    const bool met = std::abs(vertical - c.target.value) < near * c.target.value;
    if (met && solver.stands(normal, out.approach) && !(strips && solver.rough)) return out;
    solver.rough = false;
    // creep forces are nearly proportional to the normal force, the approach to its root (2/3 power for one ellipse)
    target.value *= ratio;
    const double expected = out.approach * std::sqrt(ratio);
    if (!solver.stands(normal, expected)) solver.follow(expected);
    out = evaluate_pair(c, solver, normal, tangential, solver.solve(normal, target), maps);
  }
  add_missed_load(c, out);
  return out;
}

/// As meet_load_on_one, for separate regions that share the load: their common unknown is the vertical position of the
/// wheel.
PatchResult meet_load_apart(const PatchCase& c, PatchContactSolver& solver, const std::string& normal,
                            const std::string& tangential, bool maps) {
  const double near = normal == "semi-hertz" ? 3e-4 : 1e-4;
  solver.rough = false;
  double depth = solver.depth(), low = 0.0, high = infinity, last = 0.0, last_off = 0.0;
  PatchResult out;
  for (int k = 0; k < most_rounds; ++k) {
    solver.seat(depth);
    out = evaluate_pair(c, solver, normal, tangential, solver.solve_apart(normal), maps);
    if (!c.target.by_force) return out;
    const double vertical = vertical_force(out), off = vertical - c.target.value;
    if (std::abs(off) < near * c.target.value) return out;
    (off < 0.0 ? low : high) = depth;
    // first by the power 3/2 of one ellipse, then by secants within the known bracket
    double next = depth * std::pow(std::clamp(c.target.value / vertical, 0.3, 3.0), 2.0 / 3.0);
    if (k > 0 && off != last_off) next = depth - off * (depth - last) / (off - last_off);
    if (!(next > low && next < high)) next = high < infinity ? 0.5 * (low + high) : 2.0 * low;
    last = depth;
    last_off = off;
    depth = next;
  }
  add_missed_load(c, out);
  return out;
}

PatchResult meet_load(const PatchCase& c, PatchContactSolver& solver, const std::string& normal,
                      const std::string& tangential, bool maps) {
  return solver.apart(normal) ? meet_load_apart(c, solver, normal, tangential, maps)
                              : meet_load_on_one(c, solver, normal, tangential, maps);
}

}  // namespace

std::vector<PatchResult> evaluate_patch(const PatchCase& c, bool maps) {
  PatchContactSolver solver(c, maps);
  std::vector<PatchResult> all;
  for (const std::string& normal : c.normal) {
    std::vector<std::string> tangential = c.tangential;
    if (tangential.empty()) tangential.push_back("");
    for (const std::string& name : tangential) {
      const double begin = cpu_seconds();
      solver.begin_pair();
      PatchResult out = meet_load(c, solver, normal, name, maps);
      add_damage(out, c);
      out.milliseconds = 1e3 * (solver.seconds() + cpu_seconds() - begin);
      all.push_back(std::move(out));
    }
  }
  return all;
}

}  // namespace epafi
