#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "detection/convex_corpus.h"
#include "detection/narrow/gjk/convex_answer.h"
#include "scenes/processor_time.h"
#include "scenes/study/chart.h"

namespace epafi {
namespace {

constexpr double finest = 1e-17;  // errors below what doubles show are drawn here: the axis is logarithmic

/// Value of a key among overrides like key="value"; empty where it is not set.
std::string value_of(const std::vector<std::string>& overrides, const std::string& key) {
  for (const auto& o : overrides)
    if (o.compare(0, key.size() + 1, key + "=") == 0) {
      std::string value = o.substr(key.size() + 1);
      std::erase(value, '"');
      return value;
    }
  return {};
}

struct Question {
  ConvexHull a, b;
  Pose pose_a, pose_b;
  const CorpusPair* pair;
};

std::vector<Question> questions(const std::vector<CorpusPair>& corpus, const std::string& category) {
  std::vector<Question> out;
  for (const CorpusPair& p : corpus) {
    if (!category.empty() && category != "all" && p.category != category) continue;
    out.push_back({ConvexHull::from_faces(p.a.vertices, p.a.faces).hull,
                   ConvexHull::from_faces(p.b.vertices, p.b.faces).hull,
                   {p.a.centre, Quat(1, 0, 0, 0)},
                   {p.b.centre, Quat(1, 0, 0, 0)},
                   &p});
  }
  return out;
}

/// Processor seconds per query, and the answers' errors: of the distance or depth relative to the smaller body plus a
/// thousandth of the largest coordinate.
double ask_all(const std::vector<Question>& all, ConvexMethod method, ChartPoint& point) {
  std::vector<ConvexAnswer> answers(all.size());
  const double begin = thread_seconds();
  for (std::size_t k = 0; k < all.size(); ++k)
    answers[k] = ask(method, all[k].a.view(), all[k].b.view(), all[k].pose_a, all[k].pose_b);
  const double end = thread_seconds();
  point.error = finest;
  point.status = "completed";
  point.trouble.clear();
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const CorpusPair& p = *all[k].pair;
    // resolution: 1e-12 of the size and of a thousandth of the largest coordinate, which doubles know to 1e-16
    point.error = std::max(point.error, std::abs(answers[k].distance - p.distance) * 1e-12 / p.resolution());
    wrong += std::abs(p.distance) > p.resolution() && (answers[k].distance < 0) != (p.distance < 0);
  }
  if (wrong > 0) {
    point.status = "wrong_class";
    point.trouble = fmt::format("{} pairs on the wrong side of touching", wrong);
  }
  return (end - begin) / static_cast<double>(all.size());
}

}  // namespace

bool is_corpus_study(const Study& study) { return std::filesystem::path(study.scene).extension() == ".bin"; }

Chart run_corpus_chart(const Study& study, const std::function<void(const std::string&)>& say) {
  if (study.error.name != "depth")
    throw SceneError(study.file + ": the error of a study of pairs is 'depth', not '" + study.error.name + "'");
  const std::vector<CorpusPair> corpus = read_corpus(study.scene);
  Chart chart;
  chart.study = study;
  chart.time_label = "processor seconds per query";
  chart.command = "epafi narrow " + study.scene;
  std::vector<std::vector<double>> times(study.methods.size());
  std::vector<std::vector<Question>> asked;
  for (const StudyMethod& m : study.methods) {
    const std::string name = value_of(m.overrides, "narrow.method"),
                      category = value_of(m.overrides, "narrow.category");
    if (!convex_method(name))
      throw SceneError(study.file + ": narrow.method = '" + name + "' is none of auto, sat, gjk-epa");
    asked.push_back(questions(corpus, category));
    if (asked.back().empty())
      throw SceneError(study.file + ": no pair of '" + study.scene + "' is of the category '" + category + "'");
    chart.points.push_back({});
    chart.points.back().method = m;
  }
  for (int round = 0; round < study.repeats; ++round)
    for (std::size_t k = 0; k < study.methods.size(); ++k) {
      ChartPoint& p = chart.points[k];
      times[k].push_back(ask_all(asked[k], *convex_method(value_of(p.method.overrides, "narrow.method")), p));
      if (round == 0)
        say(fmt::format("{}/{} {} [{}]: {}, {:.0f} ns, error {:.3g}", k + 1, times.size(), p.method.name,
                        p.method.settings(), p.status, 1e9 * times[k].back(), p.error));
    }
  for (std::size_t k = 0; k < times.size(); ++k) set_times(chart.points[k], times[k]);
  chart.one_question = false;  // each kind of pair is a question of its own
  return chart;
}

}  // namespace epafi
