/// @file study.h  A study: one scene, what to vary, and the error that judges it (`epafi chart`), or the parameter
/// whose limit is sought (`epafi limits`). Read strictly: an unknown key is an error with its place and the nearest.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/units/error.h"

namespace epafi {

/// A method with its settings: one point of a chart, one row of a map.
struct StudyMethod {
  std::string name;                    ///< `name` in vary, else the solver, law or method that it sets
  std::vector<std::string> overrides;  ///< "contact.nonsmooth.iterations=50"
  std::string settings() const;        ///< the overrides behind each other, "; " between
};

/// The quantity of a study's `error`.
struct ErrorSpec {
  std::string name;                ///< overlap, energy, residual, momentum, distance, or a measure of the scene
  std::string component;           ///< of a measure; empty: all of them
  std::string statistic = "last";  ///< last, min, max
  std::optional<double> exact;     ///< closed form or published value; else the reference run, else 0
  bool relative = false;           ///< divided by the exact or reference value
  std::string label;               ///< of the axis, with the unit; empty: made from the rest
  Place place{};                   ///< in the file; line 0: default
  std::string axis_label() const;
  /// Error for a quantity that is not in `known`, with its place in the study.
  [[noreturn]] void refuse(const std::string& study_file, const std::string& known) const;
};

/// A parameter of `limits` that is scanned, or bisected for its last good value.
struct ParameterSpec {
  std::string key;
  std::vector<double> values;  ///< scanned; of a bisection its two ends
  bool bisect = false, log = false, integer = false;
  double tolerance = 0.02;  ///< of a bisection, relative to the value
  std::string label;        ///< of the axis, with the unit
};

/// quantity > limit is a failure.
struct FailureSpec {
  std::string quantity;  ///< energy_error, overlap_relative, momentum_error, residual, iterations,
                         ///< bodies_lost, ns_per_body_step, broad_phase_ns (that stage alone), NAME or
                         ///< NAME.component of a measure (at the end), NAME.component.max or .min
  double limit = 0.0;
};

struct Study {
  std::string title, file, scene;  ///< scene: path as usable from here
  std::vector<std::string> fixed;  ///< overrides of every case: `set`
  std::vector<StudyMethod> methods;
  ErrorSpec error;
  std::vector<ErrorSpec> more_errors;  ///< of the same runs: a column and a picture each
  std::optional<double> accuracy;      ///< largest error that is good enough, beside the scene's [accuracy]
  std::vector<std::string> again;      ///< overrides under which the recommended method is run once more: another seed
  bool has_again = false;
  enum class Cost { run, broad_phase };
  Cost cost = Cost::run;  ///< what time means: of the run per simulated second, or of a stage per body and step
  std::string axis;       ///< key whose value stands on the x axis, time on the y axis; empty: error over time
  std::string axis_label;
  std::vector<std::string> reference;  ///< overrides of the reference run; empty: none
  bool has_reference = false;
  std::vector<ParameterSpec> parameters;  ///< one or two; of two the first is scanned
  std::vector<FailureSpec> fails_when;
  std::string theory;  ///< expression of x (the first parameter) for the limit of the last one; empty: none
  std::string theory_label;
  int repeats = 3;           ///< timings of each point
  double time_limit = 60.0;  ///< processor time of one case per thread [s]
  double budget = 0.0;       ///< wall time of all cases [s]; later ones are not run; 0: no limit
  int threads = 1;
  std::string program = "/proc/self/exe";  ///< that runs the cases
};

/// Text as a cell of a CSV row, in double quotes.
std::string csv_text(std::string text);

/// Throws SceneError with every problem of the file.
Study read_study(const std::string& path, const std::vector<std::string>& overrides);

}  // namespace epafi
