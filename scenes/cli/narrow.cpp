#include "scenes/cli/narrow.h"

#include <fmt/format.h>

#include "detection/convex_corpus.h"
#include "detection/narrow/gjk/convex_answer.h"
#include "engine/units/error.h"
#include "engine/units/nearest.h"
#include "engine/units/random.h"
#include "scenes/cli/print.h"
#include "scenes/processor_time.h"
#include "viz_export/files/page_target.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

struct PairRow {
  ConvexAnswer answer;
  bool refused = false;
  double cold = 0.0, warm = 0.0;  ///< ns per query
};

double cpu_nanoseconds() { return 1e9 * thread_seconds(); }

constexpr int repeats = 3;
constexpr std::size_t steps = 32;  // the clock costs about 300 ns: one reading per 32 queries

template <class Query>
double nanoseconds_per_query(const Query& query) {
  double best = infinity;
  for (int r = 0; r < repeats; ++r) {
    const double begin = cpu_nanoseconds();
    for (std::size_t k = 0; k < steps; ++k) query(k);
    best = std::min(best, (cpu_nanoseconds() - begin) / static_cast<double>(steps));
  }
  return best;
}

PairRow ask_pair(const CorpusPair& p, ConvexMethod method, Random& random) {
  PairRow row;
  const auto a = ConvexHull::from_faces(p.a.vertices, p.a.faces), b = ConvexHull::from_faces(p.b.vertices, p.b.faces);
  row.refused = !a.problem.empty() || !b.problem.empty();
  if (row.refused) return row;
  const Pose pose_a{p.a.centre, Quat(1, 0, 0, 0)}, pose_b{p.b.centre, Quat(1, 0, 0, 0)};
  const PolyhedronView va = a.hull.view(), vb = b.hull.view();
  row.answer = ask(method, va, vb, pose_a, pose_b);
  ConvexAnswer last;
  PairMemory memory;
  row.cold = nanoseconds_per_query([&](std::size_t) { last = ask(method, va, vb, pose_a, pose_b); });
  const std::vector<Pose> poses = p.moving_poses(steps, random);
  row.warm = nanoseconds_per_query([&](std::size_t k) { last = ask(method, va, vb, pose_a, poses[k], &memory); });
  return row;
}

std::string csv_line(std::size_t pair, const PairRow& row) {
  if (row.refused) return fmt::format("{},refused,,,,,,,,,,,\n", pair);
  const ConvexAnswer& a = row.answer;
  const auto triple = [](const Vec3& v) { return fmt::format("{:.17g},{:.17g},{:.17g}", v.x(), v.y(), v.z()); };
  return fmt::format("{},{},{:.17g},{},{},{},{:.0f}\n", pair, a.status, a.distance, triple(a.normal),
                     triple(a.witness_a), triple(a.witness_b), row.cold);
}

std::string json_line(std::size_t pair, const PairRow& row) {
  if (row.refused) return fmt::format("    {{\"pair\": {}, \"status\": \"refused\"}}", pair);
  const ConvexAnswer& a = row.answer;
  const auto triple = [](const Vec3& v) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z()); };
  return fmt::format(
      "    {{\"pair\": {}, \"status\": \"{}\", \"distance\": {:.17g}, \"normal\": {}, \"point_a\": {}, \"point_b\": "
      "{}, \"ns\": {:.0f}}}",
      pair, a.status, a.distance, triple(a.normal), triple(a.witness_a), triple(a.witness_b), row.cold);
}

}  // namespace

int command_narrow(const NarrowOptions& options) {
  const ConvexMethod* method = convex_method(options.method);
  if (!method)
    throw SceneError("unknown method '" + options.method + "'" +
                     suggestion(options.method, {"auto", "sat", "gjk-epa"}, "methods"));
  require_not_the_input(options.out, options.corpus);
  const std::vector<CorpusPair> pairs = read_corpus(options.corpus);
  std::string text =
      options.json ? "{\n  \"pairs\": [\n" : "pair,status,distance,nx,ny,nz,pax,pay,paz,pbx,pby,pbz,ns\n";
  Random random(1, 0);
  double cold = 0.0, warm = 0.0;
  std::size_t asked = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const PairRow row = ask_pair(pairs[k], *method, random);
    asked += !row.refused;
    cold += row.cold;
    warm += row.warm;
    text += options.json ? json_line(k, row) + (k + 1 < pairs.size() ? ",\n" : "\n") : csv_line(k, row);
  }
  const double n = static_cast<double>(std::max<std::size_t>(asked, 1));
  text += options.json
              ? fmt::format("  ],\n  \"mean_ns\": {{\"cold\": {:.1f}, \"warm\": {:.1f}}}\n}}\n", cold / n, warm / n)
              : fmt::format("# mean ns cold {:.1f}, warm {:.1f}\n", cold / n, warm / n);
  if (options.out.empty()) {
    print(text);
    return 0;
  }
  write_whole_file(options.out, {text});
  return 0;
}

}  // namespace epafi
