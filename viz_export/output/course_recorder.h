/// @file course_recorder.h  progress.csv: energies, contacts and residual of a run, whatever its scene measures; for
/// whoever follows it, and for its report. Rows as in measures.csv.
#pragma once
#include <chrono>
#include <functional>

#include "engine/step/observer.h"
#include "viz_export/measures/measures_csv.h"

namespace epafi {

/// Writes rows in steps that measure the energies: at each thousandth of the run, and once a second of the clock in the
/// first thousand seconds, later at each thousandth of the elapsed time. Which rows are written depends on the clock,
/// their values do not.
class CourseRecorder final : public Observer {
 public:
  struct Setup {
    std::uint64_t steps = 0;            ///< of the run
    std::uint64_t interval = 1;         ///< steps between two looks
    bool smooth = true;                 ///< contact stores energy
    std::function<double()> overlap{};  ///< of the last look, over the radius
  };
  CourseRecorder(MeasuresCsv& csv, Setup setup) : csv_(csv), setup_(std::move(setup)) {}
  bool is_due(std::uint64_t step) const override { return step % setup_.interval == 0; }
  bool wants_energy(std::uint64_t step) const override { return is_due(step); }
  bool wants_bodies(std::uint64_t) const override { return false; }
  ContactView wants_contacts(std::uint64_t, bool) const override { return ContactView::none; }
  void observe(const StepView& view) override;

 private:
  using Clock = std::chrono::steady_clock;
  bool is_time(const StepView& view);
  MeasuresCsv& csv_;
  Setup setup_;
  std::uint64_t written_ = ~std::uint64_t{0};  ///< step of the last row
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

}  // namespace epafi
