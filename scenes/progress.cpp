#include "scenes/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace epafi {

Progress::Progress(std::uint64_t steps, std::uint64_t first, bool quiet)
    : steps_(steps),
      first_(first),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_(start_) {}

std::string clock_text(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  const auto s = std::llround(seconds);
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

void Progress::enter(const std::string& stage, std::uint64_t first_step, std::uint64_t last_step) {
  stage_ = stage.empty() ? "" : "stage '" + stage + "' ";
  begin_ = first_step;
  steps_ = last_step;
}

std::string Progress::line(Simulation& sim, const RunMonitor& monitor) const {
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  const double done = static_cast<double>(sim.steps()),
               rate = (done - static_cast<double>(first_)) / std::max(elapsed, 1e-9);
  const double eta = (static_cast<double>(steps_) - done) / rate;
  const StepReport& r = sim.work.report;
  std::string text = fmt::format(
      "{}{:5.1f} %  t {:.4g} s  ETA {}  {:.3g} steps/s  {} bodies  {} contacts  kinetic {:.3g} J  overlap {:.2g}",
      stage_,
      100.0 * (done - static_cast<double>(begin_)) / static_cast<double>(std::max<std::uint64_t>(1, steps_ - begin_)),
      sim.world.time, clock_text(eta), rate, sim.world.size(), r.touching, sim.ledger.last().kinetic,
      monitor.last_overlap().max_relative);
  if (r.has_solver) text += fmt::format("  residual {:.2g} in {} it", r.solver.residual, r.solver.iterations);
  EnergyLedger now = sim.ledger;  // a copy: a look may not extend what the run's own error is relative to
  if (!sim.is_ahead()) now.measure(sim.totals());  // work is booked every step, energies only when measured
  text += fmt::format("  energy error {:.2g}", now.relative_error());
  for (const Warning& w : sim.warnings.all()) text += "  warning: " + w.text;
  return text;
}

void Progress::print(Simulation& sim, const RunMonitor& monitor) {
  const std::string text = line(sim, monitor);
  warned_ = sim.warnings.all().size();
  if (!terminal_) {
    std::fprintf(stderr, "%s\n", text.c_str());
    return;
  }
  constexpr std::uint64_t width = 20;
  const std::uint64_t filled =
      std::min(width, width * (sim.steps() - begin_) / std::max<std::uint64_t>(1, steps_ - begin_));
  std::fprintf(stderr, "\r\033[K[%s%s] %s", std::string(filled, '#').c_str(), std::string(width - filled, '.').c_str(),
               text.c_str());
  std::fflush(stderr);
}

void Progress::update(Simulation& sim, const RunMonitor& monitor) {
  if (quiet_) return;
  const auto now = Clock::now();
  const bool warns = sim.warnings.all().size() > warned_;  // printed at once
  if (!warns && std::chrono::duration<double>(now - last_).count() < (terminal_ ? 0.5 : 10.0)) return;
  last_ = now;
  print(sim, monitor);
}

void Progress::finish(Simulation& sim, const RunMonitor& monitor) {
  if (quiet_) return;
  print(sim, monitor);
  if (terminal_) std::fprintf(stderr, "\n");
}

void report_late_sources(const Assembly& a) {
  constexpr double share = 0.02;  // a body waits for its place for some steps
  Simulation& sim = *a.simulation;
  for (const PourBodies* source : a.sources) {
    const std::uint64_t due = source->due(sim.world), came = source->poured();
    const double behind = static_cast<double>(due) - static_cast<double>(came);
    if (behind <= 2.0 + share * static_cast<double>(due)) continue;
    sim.warnings.add(
        {.kind = "source " + source->setup().name,
         .text = fmt::format("[[fill]] '{}' is slower than its rate: {} bodies have come, {} were due; what "
                             "came before leaves too little room in its region (a larger region, a "
                             "velocity or a lower rate does)",
                             source->setup().name, came, due),
         .first_step = sim.steps(),
         .first_time = sim.world.time,
         .worst_step = sim.steps(),
         .value = behind,
         .times = 1});
  }
}

}  // namespace epafi
