/// @file session_stages.cpp  Stages of a session, and its continuation with other scenes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/ranks/rank_team.h"
#include "engine/threads/order_free_sum.h"
#include "engine/threads/parallel.h"
#include "scenes/railway/on_rails.h"
#include "scenes/session.h"
#include "scenes/several_ranks.h"
#include "scenes/stage_check.h"
#include "scenes/start_run.h"

namespace epafi {

void Session::begin_record() {
  const Scene& scene = assembly_->scene;
  const Simulation& sim = *assembly_->simulation;
  record_.stage = scene.stage;
  record_.stages.push_back({scene.stages[scene.stage].name, sim.world.time, sim.world.time, 0.0, sim.steps(), ""});
}

void Session::end_record(const std::string& how) {
  const World& world = assembly_->simulation->world;
  StageRecord& now = record_.stages.back();
  now.until = world.time;
  now.clock = world.clock;
  now.ended = how;
}

/// True where the record holds more than one plain run of the scene.
bool Session::has_record() const {
  return record_.stages.size() > 1 || !record_.stages.front().name.empty() || record_.time_step ||
         !record_.start_run.empty();
}

void Session::report_dropped(const std::vector<std::string>& dropped) const {
  const std::string& name = record_.stages.back().name;
  Simulation& sim = *assembly_->simulation;
  for (const std::string& what : dropped) {
    const std::string text = (name.empty() ? "" : fmt::format("stage '{}': ", name)) + "dropped: " + what;
    sim.warnings.add({.kind = text, .text = text, .first_step = sim.steps(), .first_time = sim.world.time});
  }
}

namespace {

/// Where a stage waits for rest: the share of rotation, which friction does not stop about the normal of a contact.
std::string rotation_text(const World& world) {
  if (!world.rotates()) return "";
  const auto translation = [&](std::size_t s) {
    return world.is_movable(static_cast<Slot>(s)) ? 0.5 * world.velocity[s].squaredNorm() / world.inverse_mass[s] : 0.0;
  };
  const double all = kinetic_energy(world), rotation = all - order_free_sum(world.size(), translation);
  if (!(all > 0.0)) return "";
  return fmt::format(
      "; of {:.3g} J in the end {:.2g} was rotation, which friction does not stop about the normal of a "
      "contact",
      all, rotation / all);
}

/// Empty where the cell has the pressure that the scene asks for, to within 0.1 of it along every axis.
std::string pressure_warning(const Scene& scene, const World& world) {
  if (!scene.cell || !scene.cell->control.pressure) return "";
  const double asked = *scene.cell->control.pressure;
  const Vec3 stress = world.cell->stress(), off = (stress / asked - Vec3::Ones()).cwiseAbs();
  int axis = 0;
  if (!(off.maxCoeff(&axis) > 0.1)) return "";
  return fmt::format(
      "the cell had a pressure of {:.3g} Pa along {} in the end, not of {:.3g} Pa; it was straining by "
      "{:.2g} 1/s: run longer or begin denser",
      stress[axis], "xyz"[axis], asked, world.cell->strain_rate[axis]);
}

/// True where forces come from the run that the scene starts from, and contacts are first found in a step.
bool contacts_come_later(const Assembly& a) {
  const StartSpec& start = *a.scene.start;
  if (!a.simulation->pipeline.scheme->needs_initial_forces()) return true;
  return same_mechanics(start.made->assembly->scene, a.scene) && start.keeps_memory() && !start.at_rest;
}

}  // namespace

/// Begins a new run from its scene or from another run.
void Session::begin() {
  if (assembly_->scene.start) {
    record_.time_step = assembly_->time_step;
    for (MeasureRecorder* recorder : recorders_)
      if (recorder->wants_contacts() && contacts_come_later(*assembly_)) recorder->pass_over(0);
  }
  report_dropped(enter_simulation(*assembly_));
}

bool Session::stage_is_met() {
  const auto& until = assembly_->scene.stages[assembly_->scene.stage].until;
  const Simulation& sim = *assembly_->simulation;
  if (!until || !watched_ || watched_->sampled() != sim.steps()) return false;
  if (!until->holds(watched_->last(component_))) {
    met_since_ = -1.0;
    return false;
  }
  if (met_since_ < 0.0) met_since_ = sim.world.clock;
  if (sim.world.clock - met_since_ < until->duration - 1e-6 * sim.time_step) return false;
  end_record("condition");
  return true;
}

/// Of what the scene asks for and a stage that ends by its time did not reach.
void Session::warn_of_end(const StageSpec& stage) const {
  Simulation& sim = *assembly_->simulation;
  sim.gather_state();
  const auto add = [&](const std::string& kind, const std::string& text) {
    sim.warnings.add(
        {.kind = kind + stage.name, .text = text, .first_step = sim.steps(), .first_time = sim.world.time});
  };
  if (stage.until) {
    const bool rests = stage.until->component == "kinetic" && !stage.until->above;
    add("stage ", at_most_warning(record_.stages.back(), stage) + (rests ? rotation_text(sim.world) : ""));
  }
  if (const std::string text = pressure_warning(assembly_->scene, sim.world); !text.empty()) add("pressure ", text);
}

/// Enters the next stage; false where the present one was the last.
bool Session::next_stage() {
  const Scene& scene = assembly_->scene;
  const StageSpec& stage = scene.stages[scene.stage];
  if (record_.stages.back().ended.empty()) {
    end_record(stage.until ? "at_most" : "duration");
    warn_of_end(stage);
  }
  if (frames_ && !frames_->is_due(assembly_->simulation->steps())) assembly_->simulation->show(*frames_);
  if (scene.stage + 1 >= scene.stages.size()) return false;
  RunRecord next = record_;
  next.stage = scene.stage + 1;
  enter(scene.stage_of(scene.stage + 1), next);
  return true;
}

/// Records the fills of this stage: a later resume cannot repeat placing among the bodies of now.
void Session::keep_fills() {
  const Scene& scene = assembly_->scene;
  if (scene.stage == 0) return;
  record_.fills.resize(scene.fills.size());
  for (std::size_t i = 0; i < scene.fills.size(); ++i)
    if (scene.fills[i].stage == scene.stage && scene.fills[i].method != FillSpec::Method::pour)
      record_.fills[i] = assembly_->fill_bodies[i];
}

/// Replaces the present simulation by that of `next`.
void Session::enter(Scene next, const RunRecord& record) {
  const std::unique_ptr<Assembly> before = std::move(assembly_);
  before->simulation->gather_state();
  const bool held = same_mechanics(before->scene, next);
  AssembleOptions options;
  if (next.stage > 0)
    for (std::size_t k = record.scenes; k < record.stages.size(); ++k) options.clocks.push_back(record.stages[k].clock);
  if (next.stage > 0) options.fill_bodies = before->fill_bodies;
  if (held) options.time_step = before->time_step;
  const CarryOver carry{*before};
  options.place = [&](Assembly& to) { carry_bodies(carry, to); };
  assembly_ = assemble(std::move(next), options);
  check_conditions(*assembly_);
  RankTeam* const team = RankTeam::of_program();
  if (team) check_shareable(*assembly_);
  record_ = record;
  begin_record();
  record_.stages.back().first_step = before->simulation->steps();
  record_.time_step = assembly_->time_step;
  keep_fills();
  recorders_.clear();
  monitor_ = nullptr;
  watched_ = nullptr;
  frames_ = nullptr;
  met_since_ = -1.0;
  fresh_ = true;
  files_renew();
  add_observers();
  tracks_ = std::make_unique<TrackWatch>(*assembly_);
  const auto there = [&](StateVisitor& v) {
    for (auto& o : before->simulation->observers) o->visit(v);
  };
  const auto here = [&](StateVisitor& v) {
    for (auto& o : assembly_->simulation->observers) o->visit(v);
  };
  report_dropped(carry_memory(carry, *before, *assembly_, there, here));
  if (team) {
    const std::string text = text_of(header());
    team->announce(text);
    share_out(*assembly_, part_of(text), *team);
  }
  monitor_->begin_stage();
  std::vector<BodySpec>().swap(assembly_->scene.bodies);
  if (assembly_->scene.start) assembly_->scene.start->made.reset();
  const std::string& name = record_.stages.back().name;
  const std::string title = name.empty() ? "another scene" : fmt::format("stage '{}'", name);
  if (!quiet_)
    std::fprintf(stderr, "epafi: %s\n",
                 fmt::format("{} from t = {:.6g} s: time step {:.4g} s: {}", title, record_.stages.back().from,
                             assembly_->time_step.value, assembly_->time_step.reason)
                     .c_str());
}

void Session::change(Scene next, const RunRecord& record, std::vector<std::string> overrides) {
  if (record_.stages.back().ended.empty()) end_record("changed");
  RunRecord now = record;
  now.stages = record_.stages;
  now.stage = next.stage;
  if (next.start) {
    now.scenes = now.stages.size();
    scene_hash_ = scene_hash(next);
    overrides_ = std::move(overrides);
  }
  enter(std::move(next), now);
}

double Session::rest(std::optional<double> until) const {
  const Simulation& sim = *assembly_->simulation;
  const double left = static_cast<double>(last_step() - std::min(last_step(), sim.steps())) * sim.time_step;
  return until && is_final() ? std::max(left, *until - sim.world.time) : left;
}

void Session::extend(double until) {
  const Simulation& sim = *assembly_->simulation;
  const double more = (until - sim.world.time) / sim.time_step;
  if (more > 1e-6) extend_to_step(sim.steps() + static_cast<std::uint64_t>(std::ceil(more * (1 - 1e-9))));
}

void Session::extend_to_step(std::uint64_t steps) {
  StageRecord& now = record_.stages.back();
  if (!is_final() || steps <= assembly_->simulation->steps()) return;
  if (now.ended == "condition")
    throw SceneError("the run has ended by its condition; change something with --set KEY=VALUE to go on");
  assembly_->steps = std::max(assembly_->steps, steps - now.first_step);
  now.ended.clear();
}

}  // namespace epafi
