/// @file laws.cpp  Cost of each smooth law, ns per touching contact of one act() with the sums by body, on one thread.
/// A cubic lattice of spheres, each touching six others, shears slowly so that springs turn and slide. Beside the time:
/// error of the energy ledger over an oblique impact by the same law at 50 steps per contact, and the bits of forces and
/// torques. Processor time, the best of many short calls: other processes on the machine disturb it least.
#include <cstdio>
#include <ctime>
#include <string>

#include "engine/hash.h"
#include "engine/parallel.h"
#include "tests/support/experiments.h"

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
      contacts.append(static_cast<Slot>(k), static_cast<Slot>(k + step[axis]), c);
    }
}

double impact_error(const SmoothSetup& setup, double stiffness) {
  const double radius = 5e-3, m = 2.0 / 3.0 * pi * radius * radius * radius * 2500, modulus = 1e8 / 2 / (1 - 0.0625);
  const double time = stiffness > 0 ? pi * std::sqrt(m / stiffness)
                                    : 2.868266 * std::pow(m * m / (0.5 * radius * modulus * modulus * 2.0), 0.2);
  Rig rig = two_spheres(setup, radius, 1.0, 1e-6);
  rig.world.velocity[0].y() = 0.5;  // oblique
  return run_impact(rig, time / 50).energy_error;
}

void measure(const char* label, const ContactChoice& choice) {
  const SmoothSetup setup = setup_of(choice, {glass});
  Rig rig(setup);
  ContactSet contacts;
  lattice(rig, contacts, 14, 5e-3, smooth_needs(setup).curvature);
  StepReport report;
  std::vector<double> ns;
  for (int round = 0; round < 400; ++round) {
    const std::clock_t start = std::clock();
    for (int k = 0; k < 4; ++k) rig.stage.contact_model->act(rig.world, contacts, {1e-6, 0.5}, report);
    ns.push_back(1e9 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / 4 / static_cast<double>(report.touching));
  }
  std::sort(ns.begin(), ns.end());
  Hash hash;
  for (const auto* column : {&rig.world.force, &rig.world.torque})
    for (const Vec3& f : *column) hash.add(f.data(), 3);
  const double stiffness = choice.parameters.number_or("stiffness", 0.0);
  std::printf("%-34s %8zu %8.1f %8.1f %12.2e  %s\n", label, report.touching, ns[0], ns[200], impact_error(setup, stiffness),
              hash.hex().c_str());
}

}  // namespace

int main() {
  set_thread_count(1);
  std::printf("%-34s %8s %8s %8s %12s  %s\n", "law", "contacts", "ns best", "median", "energy err", "force hash");
  const Parameters k = parameters_of({{"stiffness", 1e4}}), v = parameters_of({{"reference_speed", 2.0}});
  measure("linear, elastic", {"linear", 1.0, 0, 0, k});
  measure("linear, damped", {"linear", 0.8, 0, 0, k});
  measure("linear, damped, friction", {"linear", 0.8, 0.3, 0, k});
  measure("hertz, elastic", {"hertz", 1.0});
  measure("hertz, damped", {"hertz", 0.8});
  measure("hunt-crossley", {"hunt-crossley", 0.8, 0, 0, v});
  measure("hertz-mindlin, elastic", {"hertz-mindlin", 1.0, 0.3});
  measure("hertz-mindlin, damped", {"hertz-mindlin", 0.8, 0.3});
  measure("hertz-mindlin, damped, rolling", {"hertz-mindlin", 0.8, 0.3, 0.05});
}
