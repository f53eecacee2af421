/// @file sweep_until.h  When sweeps stop (gauss_seidel.h says how).
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/step/report.h"

namespace epafi {

struct SweepLimits {
  int iterations = 50;
  double tolerance = 1e-6;
};

/// scale: of the change of r in a sweep that is as small as the tolerance, over it. `sweep` returns the squared change,
/// `measure` the residual, `norm` ||r||; `stop` is called at intervals.
template <class Run, class Measure, class Norm, class Stop>
SolverReport sweep_until(const SweepLimits& limits, double scale, const Run& sweep, const Measure& measure,
                         const Norm& norm, const Stop& stop) {
  constexpr double rounding = 1e-15;  // of ||r||: a change of a few ulp of most impulses is noise
  double threshold = limits.tolerance * scale;
  SolverReport report{false, 0, 0.0};
  while (report.iterations < limits.iterations) {
    const double change = std::sqrt(sweep(report.iterations));
    ++report.iterations;
    if (report.iterations % 16 == 0 && stop()) break;
    if (change > threshold) continue;
    report.residual = measure();
    report.converged = report.residual <= limits.tolerance;
    if (report.converged || change <= rounding * norm()) break;  // nothing more to gain
    threshold = change * std::min(0.5, limits.tolerance / report.residual);
  }
  return report;
}

}  // namespace epafi
