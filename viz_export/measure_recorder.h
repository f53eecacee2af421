/// @file measure_recorder.h  Samples one measure at its interval and hands the values on; keeps last, min and max for the summary.
#pragma once
#include <functional>

#include "viz_export/measures/measure.h"

namespace epafi {

class MeasureRecorder final : public Observer {
 public:
  /// Where samples go: time [s], name, components, values.
  using Sink = std::function<void(double, const std::string&, const std::vector<std::string>&, const std::vector<double>&)>;

  MeasureRecorder(std::string name, std::unique_ptr<Measure> measure, std::uint64_t every, Sink sink)
      : name_(std::move(name)), measure_(std::move(measure)), every_(every), sink_(std::move(sink)),
        components_(measure_->components()), statistics_(components_.size()) {}

  bool is_due(std::uint64_t step) const override { return every_.is_due(step); }
  bool wants_energy(std::uint64_t) const override { return measure_->wants_energy(); }
  void observe(const StepView& view) override;
  void visit(StateVisitor& visitor) override;

  struct Statistics {
    double last = 0, min = infinity, max = -infinity;
  };
  const std::string& name() const { return name_; }
  const std::vector<std::string>& components() const { return components_; }
  const std::vector<Statistics>& statistics() const { return statistics_; }

 private:
  std::string name_;
  std::unique_ptr<Measure> measure_;
  EverySteps every_;
  Sink sink_;
  std::vector<std::string> components_;
  std::vector<Statistics> statistics_;
  std::vector<double> values_;
};

}  // namespace epafi
