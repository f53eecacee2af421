#include "viz_export/output/course_recorder.h"

#include <algorithm>

namespace epafi {

bool CourseRecorder::is_time(const StepView& view) {
  constexpr std::uint64_t parts = 1000;
  if (view.last || written_ == ~std::uint64_t{0}) return true;
  if (view.step - written_ >= setup_.steps / parts + 1) return true;
  const auto now = Clock::now();
  return now - last_ >= std::max<Clock::duration>(std::chrono::seconds(1), (now - start_) / parts);
}

void CourseRecorder::observe(const StepView& view) {
  if (view.step == written_ || !is_time(view)) return;
  written_ = view.step;
  last_ = Clock::now();
  const double time = view.world.time;
  const Energy& e = view.ledger.last();
  csv_.add(time, "energy", "kinetic", e.kinetic);
  csv_.add(time, "energy", "potential", e.potential);
  if (setup_.smooth) csv_.add(time, "energy", "elastic", e.elastic);
  csv_.add(time, "energy", "dissipated", e.dissipated);
  csv_.add(time, "energy", "work", e.work);
  csv_.add(time, "energy", "relative_error", view.ledger.relative_error());
  csv_.add(time, "contacts", "number", static_cast<double>(view.report.touching));
  csv_.add(time, "contacts", "overlap_relative", setup_.overlap());
  if (!view.report.has_solver) return;
  csv_.add(time, "solver", "residual", view.report.solver.residual);
  csv_.add(time, "solver", "iterations", view.report.solver.iterations);
}

}  // namespace epafi
