/// @file laws.cpp  Cost of each smooth law, ns per touching contact of one act() with the sums by body, on one thread.
/// A cubic lattice of spheres, each touching six others, shears slowly so that springs turn and slide. Beside the time:
/// errors of an oblique impact by the same law at 50 steps per contact, and the bits of forces and
/// torques. Processor time, the best of many short calls: other processes on the machine disturb it least.
#include <cstdio>
#include <ctime>
#include <string>

#include "engine/state/hash.h"
#include "engine/threads/parallel.h"
#include "laws/smooth/critical_step.h"
#include "tests/support/experiments.h"
#include "viz_export/report/charts.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const Material glass{"glass", 2500, 1e8, 0.25};

/// Contacts of a lattice of n^3 spheres of radius r overlapped by 1e-3 r, in canonical order.
void lattice(Rig& rig, ContactSet& contacts, int n, double radius, bool curvature) {
  const double pitch = 2 * radius * (1 - 5e-4);
  for (int k = 0; k < n * n * n; ++k) {
    const Vec3 place(k % n, k / n % n, k / n / n);
    rig.add_sphere(radius, 2500, pitch * place, 0.01 * Vec3(place.y(), -place.x(), place.z()) / n, {1, 2, 3});
  }
  contacts.with_curvature = curvature;
  const int step[3] = {1, n, n * n};
  for (int k = 0; k < n * n * n; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      if (k / step[axis] % n == n - 1) continue;
      ContactPoint c;
      c.gap = pitch - 2 * radius;
      c.normal = Vec3::Unit(axis);
      c.arm = 0.5 * pitch * c.normal;
      c.effective_radius = 0.5 * radius;
      c.area = pi * radius * radius * 5e-4;
      contacts.append(static_cast<Slot>(k), static_cast<Slot>(k + step[axis]), c);
    }
}

/// Oblique impact of two spheres with relative speed 2 at 50 steps per contact: error of the ledger, and of what comes
/// out against the same at 4000 steps (change of the relative velocity over 2).
struct ImpactError {
  double ledger, outcome;
};
ImpactError impact_error(const SmoothSetup& setup) {
  const double radius = 5e-3, m = 2.0 / 3.0 * pi * radius * radius * radius * 2500;
  const double time = estimate_impact(setup, setup.materials.of(0, 0), {m, 0.5 * radius, 2.0}).contact_time;
  const auto shoot = [&](int steps, double& error) {
    Rig rig = two_spheres(setup, radius, 1.0, 0.7 * 2 * time / steps);
    rig.detection->reach = smooth_reach(setup, 0.5 * radius);
    rig.world.velocity[0].y() = 0.5;
    error = run_impact(rig, time / steps).energy_error;
    return Vec3(rig.world.velocity[0] - rig.world.velocity[1]);
  };
  double ledger = 0.0, unused = 0.0;
  const Vec3 coarse = shoot(50, ledger), fine = shoot(4000, unused);
  return {ledger, 0.5 * (coarse - fine).norm()};
}

/// Of act() on the lattice.
struct Cost {
  double best, median;  ///< [ns per contact]
  std::size_t contacts;
  std::string hash;  ///< of forces and torques
};

Cost cost_of(const SmoothSetup& setup, bool rotates) {
  Rig rig(setup, Columns{.rotation = rotates});
  ContactSet contacts;
  contacts.with_area = smooth_needs(setup).area;
  lattice(rig, contacts, 14, 5e-3, smooth_needs(setup).curvature);
  StepReport report;
  std::vector<double> ns;
  for (int round = 0; round < 400; ++round) {
    const std::clock_t start = std::clock();
    for (int k = 0; k < 4; ++k) rig.stage.contact_model->act(rig.world, contacts, {1e-6, 0.5}, report);
    ns.push_back(1e9 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / 4 /
                 static_cast<double>(report.touching));
  }
  std::sort(ns.begin(), ns.end());
  Hash hash;
  for (const auto* column : {&rig.world.force, &rig.world.torque})
    for (const Vec3& f : *column) hash.add(f.data(), 3);
  return {ns[0], ns[200], report.touching, hash.hex()};
}

PlotLine measure(const char* label, const ContactChoice& choice, bool locate = false) {
  SmoothSetup setup = setup_of(choice, {glass});
  setup.locate = locate;
  const Cost cost = cost_of(setup, smooth_needs(setup).rotation);
  const ImpactError error = impact_error(setup);
  std::printf("%-38s %8zu %8.1f %8.1f %12.2e %12.2e  %s\n", label, cost.contacts, cost.best, cost.median, error.ledger,
              error.outcome, cost.hash.c_str());
  return {label, {{cost.best, std::max(error.outcome, 1e-12)}}, {}};
}

/// What one declared need costs: two laws that differ in it alone, or nearly.
struct NeedRow {
  const char* need;
  ContactChoice without, with;
  bool rotates_without = false, rotates_with = false;
};

/// Prints ns per contact without and with each need, and draws them.
void measure_needs(const std::vector<NeedRow>& rows, const char* folder) {
  KindMap map;
  map.title = "Smooth contact: what a declared need costs";
  map.x_label = "processor time per contact [ns]";
  map.log_x = true;
  map.kinds = {"without", "with"};
  std::printf("\n%-38s %10s %10s %10s\n", "need", "without", "with", "cost [ns]");
  for (const NeedRow& row : rows) {
    const double a = cost_of(setup_of(row.without, {glass}), row.rotates_without).best,
                 b = cost_of(setup_of(row.with, {glass}), row.rotates_with).best;
    std::printf("%-38s %10.1f %10.1f %10.1f\n", row.need, a, b, b - a);
    const auto y = static_cast<double>(map.y_names.size());
    map.y_names.push_back(row.need);
    map.cells.push_back({a, y, 0});
    map.cells.push_back({b, y, 1});
  }
  if (folder) draw(map, std::string(folder) + "/needs");
}

const Parameters k = parameters_of({{"stiffness", 1e4}}), v = parameters_of({{"reference_speed", 2.0}}),
                 n = parameters_of({{"stiffness", 1e6}, {"exponent", 1.5}}),
                 w = parameters_of({{"work_of_adhesion", 0.01}});

ContactChoice with_tangential(const char* law, const char* tangential, double mu_r = 0.0, const char* rolling = "") {
  ContactChoice c{law, 0.8, 0.3, mu_r};
  c.tangential = tangential;
  c.rolling = rolling;
  return c;
}

std::vector<PlotLine> measure_laws() {
  std::vector<PlotLine> lines;
  const auto add = [&](const char* label, const ContactChoice& choice, bool locate = false) {
    lines.push_back(measure(label, choice, locate));
  };
  add("linear, elastic", {"linear", 1.0, 0, 0, k});
  add("linear, damped", {"linear", 0.8, 0, 0, k});
  add("linear, damped, friction", {"linear", 0.8, 0.3, 0, k});
  add("hertz, elastic", {"hertz", 1.0});
  add("hertz, elastic, located", {"hertz", 1.0}, true);
  add("hertz, damped", {"hertz", 0.8});
  add("hertz, damped, located", {"hertz", 0.8}, true);
  add("hunt-crossley", {"hunt-crossley", 0.8, 0, 0, v});
  add("power-law 3/2, damped", {"power-law", 0.8, 0, 0, n});
  add("kuwabara-kono", {"kuwabara-kono", 1.0, 0, 0, parameters_of({{"relaxation_time", 1e-5}})});
  add("walton-braun", {"walton-braun", 0.8, 0, 0, k});
  add("dmt", {"dmt", 0.8, 0, 0, w});
  add("jkr", {"jkr", 0.8, 0, 0, w});
  add("hertz-mindlin, elastic", {"hertz-mindlin", 1.0, 0.3});
  add("hertz-mindlin, damped", {"hertz-mindlin", 0.8, 0.3});
  add("hertz-mindlin, damped, located", {"hertz-mindlin", 0.8, 0.3}, true);
  add("hertz, mindlin-deresiewicz", with_tangential("hertz", "mindlin-deresiewicz"));
  add("hertz, mindlin-dashpot", with_tangential("hertz", "mindlin-dashpot"));
  add("hertz-mindlin, rolling spring", {"hertz-mindlin", 0.8, 0.3, 0.05});
  add("hertz-mindlin, rolling constant", with_tangential("hertz", "mindlin", 0.05, "constant"));
  return lines;
}

void measure_all_needs(const char* folder) {
  const ContactChoice spring{"linear", 1.0, 0, 0, k}, damped{"linear", 0.8, 0, 0, k},
      mindlin{"hertz-mindlin", 0.8, 0.3};
  measure_needs({{"rotation: spins in the velocity", damped, damped, false, true},
                 {"velocity at the detection: a damper", spring, damped},
                 {"curvature: radius, power 3/2 by it", {"power-law", 1.0, 0, 0, n}, {"hertz", 1.0}},
                 {"area and curvature: overlap volume", damped, {"overlap-volume", 0.8}},
                 {"memory of the normal part", spring, {"walton-braun", 1.0, 0, 0, k}},
                 {"slip velocity and memory: friction", damped, {"linear", 0.8, 0.3, 0, k}, true, true},
                 {"contact moment: rolling spring", mindlin, {"hertz-mindlin", 0.8, 0.3, 0.05}, true, true},
                 {"whole history of slip", mindlin, with_tangential("hertz", "mindlin-deresiewicz"), true, true}},
                folder);
}

}  // namespace

/// perf_laws FOLDER also draws FOLDER/laws.svg, cost against error of the impact, and FOLDER/needs.svg, cost of each
/// declared need.
int main(int argc, char** argv) {
  set_thread_count(1);
  std::printf("%-38s %8s %8s %8s %12s %12s  %s\n", "law", "contacts", "ns best", "median", "ledger err", "outcome err",
              "force hash");
  const std::vector<PlotLine> lines = measure_laws();
  measure_all_needs(argc > 1 ? argv[1] : nullptr);
  if (argc > 1)
    draw(ScatterPlot{"Smooth laws: cost and error of the same oblique impact at 50 steps",
                     "processor time per contact [ns]",
                     "error of the outgoing velocity [-]",
                     lines,
                     {},
                     {},
                     {},
                     false},
         std::string(argv[1]) + "/laws");
}
