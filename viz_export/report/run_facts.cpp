#include "viz_export/report/run_facts.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/units/error.h"
#include "viz_export/files/run_mark.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

/// Last, smallest and largest value of each component.
void add_measure(const StoredMeasure& m, FlatJson& out) {
  const std::size_t width = m.components.size();
  for (std::size_t c = 0; c < width; ++c) {
    const std::string at = "measures." + m.name + "." + m.components[c] + ".";
    for (std::size_t row = 0; row < m.times.size(); ++row) {
      const double value = m.values[row * width + c];
      if (!std::isfinite(value)) continue;
      out.numbers[at + "last"] = value;
      const auto low = out.numbers.try_emplace(at + "min", value).first;
      const auto high = out.numbers.try_emplace(at + "max", value).first;
      low->second = std::min(low->second, value);
      high->second = std::max(high->second, value);
    }
  }
}

void add_energies(const StoredMeasure& m, FlatJson& out) {
  const std::size_t width = m.components.size();
  for (std::size_t c = 0; m.kind == "energy" && !m.times.empty() && c < width; ++c)
    if (const double value = m.values[(m.times.size() - 1) * width + c]; std::isfinite(value))
      out.numbers["energy." + m.components[c]] = value;
}

/// The summary, or why it is not valid: truncated, or other JSON.
struct SummaryReading {
  FlatJson summary;
  std::string damage{};
};

SummaryReading read_summary(const fs::path& file) {
  SummaryReading out;
  try {
    out.summary = read_json(file);
    if (out.summary.text("status").empty()) out.damage = "'" + file.string() + "' names no status of a run";
  } catch (const FileError& e) {
    out.damage = e.what();
  }
  return out;
}

}  // namespace

FlatJson run_facts(const fs::path& folder) {
  if (fs::exists(folder / "summary.json"))
    if (SummaryReading read = read_summary(folder / "summary.json"); read.damage.empty()) return read.summary;
  return run_facts(folder, *open_run(folder, "report"));
}

FlatJson run_facts(const fs::path& folder, const ViewSource& source) {
  const RunState state = run_state(folder);
  FlatJson out;
  if (state.life == RunLife::over) {
    SummaryReading read = read_summary(folder / "summary.json");
    if (read.damage.empty()) return read.summary;
    out.texts["warnings.summary"] = read.damage + ": what is shown comes from the other files of the run";
  }
  out.texts["status"] = state.life == RunLife::running ? "running" : "cut";
  out.numbers["simulated_time"] = source.last_time();
  if (!source.times().empty())
    out.numbers["bodies"] = static_cast<double>(source.frame(source.times().size() - 1).bodies.size());
  for (std::size_t k = 0; k < state.warnings.size(); ++k) out.texts[fmt::format("warnings.{}", k)] = state.warnings[k];
  for (const StoredMeasure& m : source.measures()) {
    add_measure(m, out);
    add_energies(m, out);
  }
  return out;
}

}  // namespace epafi
