#include "viz_export/output/output_observers.h"

#include <cmath>
#include <limits>

#include "engine/units/error.h"

namespace epafi {

void StateRecorder::observe(const StepView& view) {
  if (beside_ != nullptr) beside_->wait();  // the copy and the files are in use until then
  const World& world = view.world;
  Files::Snapshot snapshot;
  if (files_->run != nullptr)
    snapshot = files_->run->begin_snapshot(
        {view.step, world.time, {}, world.rotates(), world.has_orientation(), files_->stage});
  const bool draws = files_->frames != nullptr;
  const std::vector<float> residuals = draws && residuals_ ? residuals_() : std::vector<float>();
  const ContactList contacts = draws ? ContactList(world, view.pieces(), residuals) : ContactList();
  const std::size_t bytes = world.size() * world.bytes_per_body() + contacts.size() * ContactSet().bytes_per_contact();
  if (beside_ == nullptr || bytes > most_copied) return files_->write(world, contacts, std::move(snapshot));
  if (!copy_) copy_ = std::make_shared<Copy>();
  copy_->world.copy_shown(world);
  contacts.copy(copy_->contacts, copy_->residuals);
  beside_->add([files = files_, copy = copy_, snapshot = std::move(snapshot)] {
    files->write(copy->world, ContactList(copy->world, copy->contacts, copy->residuals), snapshot);
  });
}

void StateRecorder::Files::write(const World& world, const ContactList& contacts, Snapshot snapshot) {
  const BodyList bodies(world, surfaces);
  const auto save = [&] {
    if (!snapshot) return;
    snapshot->stamp.state_hash = state_hash(world);
    run->write(*snapshot, bodies);
  };
  if (frames == nullptr) return save();
  frames->name_stage(stage);
  frames->write(world.time, bodies, contacts, save);
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
    // fmin ignores NaN
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
