#include "viz_export/output/output_observers.h"

#include <cmath>
#include <limits>

#include "engine/units/error.h"

namespace epafi {

void StateRecorder::observe(const StepView& view) {
  const World& world = view.world;
  const BodyList bodies(world, surfaces_);
  const auto snapshot = [&] {
    if (run_ == nullptr) return;
    run_->add_snapshot({view.step, world.time, state_hash(world), world.rotates(), world.has_orientation(), stage_},
                       bodies);
  };
  if (frames_ == nullptr) return snapshot();
  frames_->name_stage(stage_);
  const std::vector<float> residuals = residuals_ ? residuals_() : std::vector<float>();
  frames_->write(world.time, bodies, ContactList(world, view.pieces(), residuals), snapshot);
}

MeasureRecorder::MeasureRecorder(std::string name, std::unique_ptr<Measure> measure, MeasuresCsv* csv, RunFile* run,
                                 EverySteps due, const std::string& kind, std::uint64_t written)
    : name_(std::move(name)),
      measure_(std::move(measure)),
      components_(measure_->components()),
      csv_(csv),
      run_(run),
      due_(due),
      written_(written) {
  if (run_ != nullptr) number_ = run_->define_measure(name_, components_, kind);
  last_.assign(components_.size(), std::numeric_limits<double>::quiet_NaN());
  min_ = max_ = last_;
}

void MeasureRecorder::observe(const StepView& view) {
  if (view.step == sampled_) return;  // a resumed run looks again at the state it was saved in
  sampled_ = view.step;
  measure_->sample(view, values_);
  EPAFI_REQUIRE(values_.size() == components_.size(), "one value per component");
  const bool is_written = view.step % written_ == 0 || view.last;
  if (run_ != nullptr && is_written) run_->add_measure(number_, view.world.time, values_);
  for (std::size_t c = 0; c < values_.size(); ++c) {
    if (csv_ != nullptr && is_written) csv_->add(view.world.time, name_, components_[c], values_[c]);
    last_[c] = values_[c];
    if (std::isnan(values_[c])) continue;
    // fmin passes over NaN
    min_[c] = std::fmin(min_[c], values_[c]);
    max_[c] = std::fmax(max_[c], values_[c]);
  }
}

void MeasureRecorder::visit(StateVisitor& visitor) {
  const std::string prefix = "measure/" + name_;
  visitor.value(prefix + "/sampled", sampled_);
  visitor.column(prefix + "/last", last_);
  visitor.column(prefix + "/min", min_);
  visitor.column(prefix + "/max", max_);
  measure_->visit(visitor, prefix + "/own");
}

std::map<std::string, RunSummary::Component> MeasureRecorder::summary() const {
  std::map<std::string, RunSummary::Component> out;
  for (std::size_t c = 0; c < components_.size(); ++c)
    if (!std::isnan(min_[c])) out[components_[c]] = {last_[c], min_[c], max_[c]};
  return out;
}

}  // namespace epafi
