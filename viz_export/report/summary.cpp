#include "viz_export/report/summary.h"

#include "viz_export/files/json_writer.h"
#include "viz_export/files/side_file.h"

namespace epafi {

namespace {

void put_stages(JsonWriter& json, const StageSeconds& seconds) {
  constexpr std::array order{Stage::broad_phase, Stage::narrow_phase, Stage::contact,
                             Stage::integrate,   Stage::events,       Stage::output};
  const auto put = [&](const char* key, const std::array<double, stage_count>& values) {
    json.key(key).begin_object();
    for (const Stage s : order)
      json.member(stage_names[static_cast<std::size_t>(s)], values[static_cast<std::size_t>(s)]);
    json.end_object();
  };
  put("stage_seconds", seconds.seconds);
  put("serial_seconds", seconds.serial);
}

void put_energy(JsonWriter& json, const RunSummary::Energy& e) {
  json.key("energy").begin_object();
  json.member("kinetic", e.kinetic).member("potential", e.potential).member("elastic", e.elastic);
  json.member("dissipated", e.dissipated).member("work", e.work).member("gained", e.gained);
  json.member("correction", e.correction).member("relative_error", e.relative_error);
  json.end_object();
}

void put_max_mean(JsonWriter& json, const char* name, const std::optional<RunSummary::MaxMean>& v) {
  if (v) json.key(name).begin_object().member("max", v->max).member("mean", v->mean).end_object();
}

void put_measures(JsonWriter& json, const RunSummary& s) {
  json.key("measures").begin_object();
  for (const auto& [name, components] : s.measures) {
    json.key(name).begin_object();
    for (const auto& [component, v] : components)
      json.key(component).begin_object().member("last", v.last).member("min", v.min).member("max", v.max).end_object();
    json.end_object();
  }
  json.end_object();
}

void put_warnings(JsonWriter& json, const std::vector<std::string>& warnings) {
  json.key("warnings").begin_array();
  for (const std::string& text : warnings) json.value(text);
  json.end_array();
}

void put_checks(JsonWriter& json, const char* key, const std::map<std::string, RunSummary::Check>& checks) {
  json.key(key).begin_object();
  for (const auto& [name, c] : checks)
    json.key(name).begin_object().member("value", c.value).member("bound", c.bound).member("ok", c.ok).end_object();
  json.end_object();
}

void put_run_stages(JsonWriter& json, const std::vector<RunSummary::StageTimes>& stages) {
  json.key("stages").begin_array();
  for (const auto& s : stages) {
    json.begin_object().member("name", s.name).member("from", s.from).member("until", s.until);
    if (!s.ended.empty()) json.member("ended", s.ended);
    json.end_object();
  }
  json.end_array();
}

void put_ranks(JsonWriter& json, const RankFigures& ranks, const std::string& share) {
  json.key("ranks").begin_object().member("count", ranks.ranks).member("share", share);
  json.member("imbalance", ranks.imbalance);
  json.member("ghosts", ranks.ghosts).member("bytes_per_step", ranks.bytes_per_step).member("moves", ranks.moves);
  json.key("seconds").begin_array();
  for (const RankSeconds& seconds : ranks.seconds) {
    json.begin_object();
    for (std::size_t k = 0; k < seconds.size(); ++k) json.member(rank_stage_names[k], seconds[k]);
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

}  // namespace

std::string summary_json(const RunSummary& s) {
  JsonWriter json;
  json.begin_object();
  json.member("epafi", s.epafi).member("scene", s.scene).member("scene_hash", s.scene_hash).member("status", s.status);
  if (!s.failure.empty()) json.member("failure", s.failure);
  put_warnings(json, s.warnings);
  if (!s.stop_reason.empty()) json.member("stopped", s.stop_reason);
  if (!s.stages.empty()) put_run_stages(json, s.stages);
  json.member("bodies", s.bodies).member("bodies_lost", s.bodies_lost).member("bodies_removed", s.bodies_removed);
  json.member("steps", s.steps).member("time_step", s.time_step).member("simulated_time", s.simulated_time);
  json.member("wall_time", s.wall_time)
      .member("cpu_time", s.cpu_time)
      .member("threads", s.threads)
      .member("ns_per_body_step", s.ns_per_body_step);
  put_stages(json, s.stage_seconds);
  if (s.ranks) put_ranks(json, *s.ranks, s.ranks_share);
  json.member("contacts_mean", s.contacts_mean);
  if (s.energy) put_energy(json, *s.energy);
  json.member("momentum_error", s.momentum_error);
  if (s.overlap)
    json.key("overlap")
        .begin_object()
        .member("max", s.overlap->max)
        .member("mean", s.overlap->mean)
        .member("max_relative", s.overlap->max_relative)
        .end_object();
  put_max_mean(json, "residual", s.residual);
  put_max_mean(json, "iterations", s.iterations);
  json.member("unconverged_steps", s.unconverged_steps);
  put_measures(json, s);
  put_checks(json, "checks", s.checks);
  if (!s.accuracy.empty()) put_checks(json, "accuracy", s.accuracy);
  json.member("peak_memory_bytes", s.peak_memory_bytes).member("state_hash", s.state_hash);
  json.end_object();
  return json.text() + "\n";
}

void write_summary(const std::filesystem::path& path, const RunSummary& summary) {
  write_whole_file(path, {summary_json(summary)}, true);
}

}  // namespace epafi
