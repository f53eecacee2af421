#include "viz_export/report/summary.h"

#include "tests/support/catch.h"

using namespace epafi;
using Catch::Contains;

namespace {
std::string quoted(const char* key) { return std::string(1, '"').append(key).append("\":"); }
}  // namespace

TEST_CASE("a summary holds every key of its contract and leaves out what the scene does not have",
          "[viz_export][summary]") {
  RunSummary s;
  s.epafi = "0.1.0";
  s.scene = "hopper";
  s.status = "completed";
  s.state_hash = "00ff";
  const std::string bare = summary_json(s);
  for (const char* key : {"epafi",       "scene",          "scene_hash",   "status",         "bodies",
                          "bodies_lost", "steps",          "time_step",    "simulated_time", "wall_time",
                          "threads",     "stage_seconds",  "measures",     "checks",         "peak_memory_bytes",
                          "state_hash",  "broad_phase",    "narrow_phase", "contact",        "integrate",
                          "output",      "serial_seconds", "warnings"})
    CHECK_THAT(bare, Contains(quoted(key)));
  for (const char* key : {"energy", "momentum_error", "overlap", "residual", "iterations", "ns_per_body_step",
                          "contacts_mean", "failure"})
    CHECK_THAT(bare, !Contains(quoted(key)));

  s.energy = RunSummary::Energy{1, 2, std::nullopt, 3, 4, 0.5, std::nullopt, 1e-5};
  s.overlap = RunSummary::Overlap{1e-4, 5e-5, 0.01};
  s.residual = RunSummary::MaxMean{0.5, 0.25};
  s.measures["outflow"]["rate"] = {0.52, 0.0, 0.6};
  s.checks["drift"] = {0.1, 0.05, false};
  s.warnings = {"the balance is open by 0.1", "said \"so\""};
  const std::string full = summary_json(s);
  CHECK_THAT(full, Contains("\"the balance is open by 0.1\"") && Contains("said \\\"so\\\""));
  CHECK_THAT(full, Contains("\"gained\": 0.5"));
  CHECK_THAT(full, Contains("\"relative_error\": 1e-05") && !Contains("elastic"));
  CHECK_THAT(full, Contains("\"max_relative\": 0.01") && Contains("\"mean\": 0.25"));
  CHECK_THAT(full, Contains("\"rate\": {\n        \"last\": 0.52,\n        \"min\": 0,\n        \"max\": 0.6"));
  CHECK_THAT(full, Contains("\"ok\": false"));
}
