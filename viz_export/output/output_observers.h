/// @file output_observers.h  The observers that write files: snapshots, frames, measures.
#pragma once
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/step/observer.h"
#include "viz_export/hdf5/run_file.h"
#include "viz_export/measures/measure.h"
#include "viz_export/measures/measures_csv.h"
#include "viz_export/output/output_thread.h"
#include "viz_export/report/summary.h"
#include "viz_export/vtk/frame_writer.h"

namespace epafi {

/// Snapshots into run.h5 and frames for ParaView, as `due` says and at the end. Either may be null.
class StateRecorder final : public Observer {
 public:
  /// Bytes above which no copy is made and the step waits for the files: a bed of 150 000 spheres.
  static constexpr std::size_t most_copied = std::size_t{64} << 20;

  /// residuals(): of the contacts of the last step, or none. stage: its name, beside each snapshot and frame.
  StateRecorder(RunFile* run, FrameWriter* frames, const ShapeStore& shapes, EverySteps due,
                std::function<std::vector<float>()> residuals = {}, std::string stage = {})
      : files_(std::make_shared<Files>(Files{run, frames, SurfaceCache(shapes), std::move(stage)})),
        due_(due),
        residuals_(std::move(residuals)) {}
  /// Uses this thread from now on, with a copy of the data, while the run continues.
  void write_beside(OutputThread& thread) { beside_ = &thread; }
  bool is_due(std::uint64_t step) const override { return due_.is_due(step); }
  ContactView wants_contacts(std::uint64_t step, bool last) const override {
    return files_->frames != nullptr && (last || is_due(step)) ? ContactView::pieces : ContactView::none;
  }
  void observe(const StepView& view) override;

 private:
  struct Files {
    RunFile* run;
    FrameWriter* frames;
    SurfaceCache surfaces;
    std::string stage;
    using Snapshot = std::optional<RunFile::Snapshot>;
    void write(const World& world, const ContactList& contacts, Snapshot snapshot);
  };
  struct Copy {
    World world;
    ContactSet contacts;
    std::vector<float> residuals;
  };
  std::shared_ptr<Files> files_;
  EverySteps due_;
  std::function<std::vector<float>()> residuals_;
  OutputThread* beside_ = nullptr;
  std::shared_ptr<Copy> copy_;  ///< its room is kept from frame to frame; null before the first
};

/// Samples one measure into measures.csv, run.h5 and the summary. Either file may be null.
class MeasureRecorder final : public Observer {
 public:
  /// Looks at every `every`-th step, for files at those of them that are multiples of `written`. kind: as in the scene,
  /// for readers of run.h5.
  MeasureRecorder(std::string name, std::unique_ptr<Measure> measure, MeasuresCsv* csv, RunFile* run, EverySteps due,
                  const std::string& kind = {}, std::uint64_t written = 1);
  bool is_due(std::uint64_t step) const override { return due_.is_due(step); }
  bool wants_energy(std::uint64_t step) const override { return measure_->wants_energy() && is_due(step); }
  bool wants_bodies(std::uint64_t step) const override { return measure_->wants_bodies() && is_due(step); }
  ContactView wants_contacts(std::uint64_t step, bool last) const override {
    return last || is_due(step) ? measure_->wants_contacts() : ContactView::none;
  }
  void observe(const StepView& view) override;
  void bodies_come(const World& world, std::size_t first) override { measure_->bodies_come(world, first); }
  void bodies_leave(const World& world, std::span<const BodyId> bodies) override {
    measure_->bodies_leave(world, bodies);
  }
  void visit(StateVisitor& visitor) override;

  const std::string& name() const { return name_; }
  /// In this step nothing is known yet of what it measures.
  void pass_over(std::uint64_t step) { sampled_ = step; }
  bool wants_contacts() const { return measure_->wants_contacts() != ContactView::none; }
  /// Step of the last sample, and its value of a component.
  std::uint64_t sampled() const { return sampled_; }
  double last(std::size_t component) const { return last_[component]; }
  std::size_t components() const { return components_.size(); }
  /// Number of a component; as many as there are where there is none of the name.
  std::size_t component(const std::string& name) const {
    return static_cast<std::size_t>(std::find(components_.begin(), components_.end(), name) - components_.begin());
  }
  /// Last, smallest and largest value of each component; components never seen as a number are absent.
  std::map<std::string, RunSummary::Component> summary() const;

 private:
  std::string name_;
  std::unique_ptr<Measure> measure_;
  std::vector<std::string> components_;
  MeasuresCsv* csv_;
  RunFile* run_;
  std::size_t number_ = 0;  ///< in run.h5
  EverySteps due_;
  std::uint64_t written_;                          ///< steps between two rows of the files
  std::uint64_t sampled_ = ~std::uint64_t{0};      ///< step of the last sample
  std::vector<double> values_, last_, min_, max_;  ///< by component; NaN where there was no value yet
};

}  // namespace epafi
