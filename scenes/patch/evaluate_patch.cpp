#include "scenes/patch/evaluate_patch.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>

#include "laws/wheel_rail/normal_models.h"

namespace epafi {
namespace {

constexpr double pi = 3.14159265358979323846;

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

 private:
  double A_, B_, y1_, y2_;
};

template <class List>
const typename List::value_type& model_named(const List& list, const std::string& name) {
  return *std::find_if(list.begin(), list.end(), [&](const auto& m) { return m.entry.name == name; });
}

/// Normal contact of the case by one model; a line contact and a given ellipse are Hertz whatever the name.
struct NormalSolver {
  const PatchCase& c;
  std::unique_ptr<GapSource> source;
  std::vector<ContactRegion> regions;

  explicit NormalSolver(const PatchCase& patch) : c(patch) {
    if (!c.radii) return;
    const double A = 0.5 * (1.0 / c.radii->x1 + 1.0 / c.radii->x2), B = 0.5 * (1.0 / c.radii->y1 + 1.0 / c.radii->y2);
    if (A > 0.0 && B > 0.0) {
      source = std::make_unique<QuadraticGap>(A, B, c.radii->y1, c.radii->y2);
      regions = source->regions();
    }
  }

  std::vector<RegionPatch> solve(const std::string& model) const {
    const double E = c.elastic.effective_modulus();
    if (c.ellipse) {
      RegionPatch p{0, patch_of_hertz(hertz_of_ellipse(*c.ellipse, E, c.target.value))};
      if (model != "hertz")
        p.patch.reasons.push_back("a given ellipse has Hertz' pressure; model '" + model + "' was not run");
      return {p};
    }
    if (!source) return {line(model)};
    return model_named(all_normal_models(), model).solve({*source, regions, c.elastic, c.target, c.dx, c.dy});
  }

  RegionPatch line(const std::string& model) const {
    const double A = 0.5 * (1.0 / c.radii->x1 + 1.0 / c.radii->x2), B = 0.5 * (1.0 / c.radii->y1 + 1.0 / c.radii->y2);
    const LineContact l = hertz_line(std::max(A, B), c.elastic.effective_modulus(), c.target.value / *c.length);
    RegionPatch out;
    NormalPatch& p = out.patch;
    p.is_line = true;
    p.ellipse = A > 0.0 ? Ellipse{l.half_width, 0.5 * *c.length} : Ellipse{0.5 * *c.length, l.half_width};
    p.normal_force = c.target.value, p.max_pressure = l.max_pressure, p.area = 2.0 * l.half_width * *c.length;
    if (model != "hertz")
      p.reasons.push_back("a line contact is Hertz' plane solution; model '" + model + "' was not run");
    return out;
  }
};

/// Cells over an elliptic patch: those given, else 32 square ones along the shorter axis (at most 256 along the
/// longer).
PatchGrid cells_of(const PatchCase& c, const Ellipse& e) {
  const double shorter = 2.0 * std::min(e.a, e.b) / 32.0;
  const auto count = [](double length, double cell) {
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(length / cell)), 2, 4096);
  };
  PatchGrid g;
  g.nx = c.dx > 0.0 ? count(2.0 * e.a, c.dx) : std::min<std::size_t>(256, (count(2.0 * e.a, shorter) + 3) / 4 * 4);
  g.ny = c.dy > 0.0 ? count(2.0 * e.b, c.dy) : std::min<std::size_t>(256, (count(2.0 * e.b, shorter) + 3) / 4 * 4);
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
    c.y_wheel = regions[rp.region].y_wheel, c.y_rail = regions[rp.region].y_rail, c.angle = regions[rp.region].angle;
  }
  c.semi_axes = p.ellipse, c.area = p.area, c.max_pressure = p.max_pressure, c.normal_force = p.normal_force;
  out.contacts.push_back(c);
  out.normal_force += p.normal_force, out.area += p.area;
  out.max_pressure = std::max(out.max_pressure, p.max_pressure), out.approach = std::max(out.approach, p.approach);
  out.error_estimate = std::max(out.error_estimate, p.error_estimate);
  add_reasons(out.reasons, p.reasons);
}

void add_tangential(PatchResult& out, const PatchCase& c, const RegionPatch& rp, const TangentialModel& model,
                    bool maps) {
  const TangentialOutcome t =
      model.solve({rp.patch, c.elastic, c.friction, c.creepage, cells_of(c, rp.patch.ellipse), maps});
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

}  // namespace

std::vector<PatchResult> evaluate_patch(const PatchCase& c, bool maps) {
  const NormalSolver solver(c);
  std::vector<PatchResult> all;
  for (const std::string& normal : c.normal) {
    const double start = cpu_seconds();
    std::vector<RegionPatch> patches = solver.solve(normal);
    const double normal_seconds = cpu_seconds() - start;
    std::vector<std::string> tangential = c.tangential;
    if (tangential.empty()) tangential.push_back("");
    for (const std::string& name : tangential) {
      const double begin = cpu_seconds();
      PatchResult out;
      out.normal = normal, out.tangential = name, out.friction = !name.empty();
      for (const RegionPatch& rp : patches) {
        add_normal(out, rp, solver.regions);
        if (!name.empty() && rp.patch.normal_force > 0.0)
          add_tangential(out, c, rp, model_named(all_tangential_models(), name), maps);
      }
      add_damage(out, c);
      out.milliseconds = 1e3 * (normal_seconds + cpu_seconds() - begin);
      all.push_back(std::move(out));
    }
  }
  return all;
}

}  // namespace epafi
