/// @file chart.h  `epafi chart`: every method of a study on one scene, its cost against its error. Each timing is a
/// process of its own; the methods take turns, so that a drift of the machine falls on all of them alike.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scenes/study/study.h"

namespace epafi {

struct ChartPoint {
  StudyMethod method;
  std::string status;        ///< of its runs; "differs" where repeats gave different states
  std::string trouble;       ///< why it is no good point, empty where it is
  double time = 0.0;         ///< median of the repeats: processor seconds per simulated second
  double time_spread = 0.0;  ///< largest - smallest
  double least_time = 0.0;
  double ns_per_body_step = 0.0;
  double error = 0.0;               ///< of the study's measure
  double error_spread = 0.0;        ///< uncertainty of what it is compared with
  std::vector<double> more_errors;  ///< of the study's further measures; NaN where one cannot be had
  std::optional<double> at;         ///< value of the study's axis
  std::optional<double> residual, energy_error, overlap_relative;
  std::string state_hash;
  bool accurate = false;      ///< every entry of the scene's [accuracy] holds
  bool is_reference = false;  ///< the reference itself: never on the front
  bool pareto = false;        ///< nothing measured is both cheaper and more accurate
  bool good() const { return status == "completed"; }
};

/// The recommended settings, run once more with the study's `again`.
struct SecondOpinion {
  std::string settings;  ///< the overrides of `again`
  bool holds = false;    ///< inside [accuracy] there too
  double error = 0.0;
  std::string trouble;  ///< why it does not hold
};

struct Chart {
  Study study;
  std::vector<ChartPoint> points;
  double reference_error = 0.0;               ///< of the reference run, estimated by halving its time step
  std::vector<double> more_reference_errors;  ///< of the study's further measures
  bool asks_accuracy = false;                 ///< the scene has [accuracy], or the study `accuracy`
  std::optional<double> accuracy;             ///< of the error: the study's, or the scene's of the same name
  std::optional<std::size_t> recommended;     ///< cheapest point inside [accuracy]
  std::optional<SecondOpinion> again;
  std::string command;  ///< of the first case, as an example
  std::string time_label = "processor seconds per simulated second";
  bool one_question = true;  ///< points answer the same question: lines join them, the best make a front
};

/// Runs the study below `folder`. `say` gets a line for each case as it ends. Throws SceneError where a case is no
/// valid scene.
Chart run_chart(const Study& study, const std::filesystem::path& folder,
                const std::function<void(const std::string&)>& say);

/// The same for a wheel-rail case (a scene with [patch]): each point is one evaluation of one pair of models, so its
/// time is in processor seconds per evaluation. error: pressure, area (relative), force (over the normal force) or
/// patch (the largest of them).
Chart run_patch_chart(const Study& study, const std::function<void(const std::string&)>& say);
bool is_patch_study(const Study& study);

/// A corpus of convex pairs (tests/data/README.md) in place of a scene: each point is a method of the narrow phase
/// (narrow.method) on the pairs of a category (narrow.category), its time in processor seconds per query. error: depth,
/// the worst of the distance relative to the smaller body.
Chart run_corpus_chart(const Study& study, const std::function<void(const std::string&)>& say);
bool is_corpus_study(const Study& study);

/// Whichever of the three the study asks for.
Chart chart_of(const Study& study, const std::filesystem::path& folder,
               const std::function<void(const std::string&)>& say);

/// Median and spread of the repeats.
void set_times(ChartPoint& point, const std::vector<double>& times);
/// The first setting of every method, then the second of each, and so on: methods take turns, and where a budget ends
/// the study each of them has been seen.
std::vector<std::size_t> order_of_turns(const Study& study);
/// Points that nothing measured beats in time and error at once, in order of time. measure: 0 the study's error, k the
/// k-th further one.
std::vector<std::size_t> front_of(const Chart& chart, std::size_t measure);
/// Marks the front of the first error and the cheapest point inside [accuracy].
void mark_front(Chart& chart);
double median(std::vector<double> values);

std::string chart_csv(const Chart& chart);
std::string chart_json(const Chart& chart);
/// Verdict of the chart: error floor, failed points, the cheapest method inside [accuracy] as lines of a scene.
std::string chart_verdict(const Chart& chart);
/// A scene file that includes the study's scene and sets the recommended keys; empty where there are none.
std::string recommended_scene(const Chart& chart, const std::filesystem::path& folder);
/// chart.svg and chart.png; chart_2 ... for further errors.
void draw_chart(const Chart& chart, const std::filesystem::path& folder);

}  // namespace epafi
