/// @file narrow.cpp  Convex pairs with exact answers: time and error of the narrow phase.
/// perf_narrow: ns per candidate pair of spheres through the whole narrow phase, one thread.
/// perf_narrow CORPUS: per category ns per query: cold (the same pair again, from nothing), fresh (all pairs in turn,
/// none twice in a row: neither caches nor branches know it) and warm (moved by up to 1e-3 of the size and turned as
/// far), refused bodies, wrong classes, worst errors in units of the size; then each method alone, then scaled, turned,
/// shifted and swapped.
#include <chrono>
#include <cstdio>
#include <map>

#include "detection/convex_corpus.h"
#include "detection/narrow/gjk/convex_answer.h"
#include "detection/narrow/narrow_phase.h"
#include "engine/threads/parallel.h"
#include "scenes/processor_time.h"

using namespace epafi;

namespace {

struct Row {
  int pairs = 0, refused = 0, wrong = 0, off = 0, intervals = 0;
  double cold = 0.0, fresh = 0.0, warm = 0.0, distance = 0.0, regret = 0.0, witness = 0.0;
  void add(const Row& o) {
    pairs += o.pairs;
    refused += o.refused;
    wrong += o.wrong;
    off += o.off;
    intervals += o.intervals;
    cold += o.cold;
    fresh += o.fresh;
    warm += o.warm;
    distance = std::max(distance, o.distance);
    regret = std::max(regret, o.regret);
    witness = std::max(witness, o.witness);
  }
  void print(const std::string& name) const {
    std::printf(
        "%-28s %5d pairs  cold %6.0f ns  fresh %6.0f ns  warm %6.0f ns  refused %d  wrong class %d  off %d  interval "
        "%d  distance %.2e "
        " "
        "regret %.2e  points %.2e\n",
        name.c_str(), pairs, cold / pairs, fresh / pairs, warm / pairs, refused, wrong, off, intervals, distance,
        regret, witness);
  }
};

/// How a pair is placed otherwise: all lengths by scale, both bodies moved and turned together, A and B exchanged.
struct Placing {
  const char* name = "as stored";
  double scale = 1.0;
  Vec3 shift = Vec3::Zero();
  Quat turn{1, 0, 0, 0};
  bool swapped = false;
};

ConvexHull::Built hull_of(const CorpusBody& body, double scale) {
  std::vector<Vec3> vertices = body.vertices;
  for (Vec3& v : vertices) v *= scale;
  return ConvexHull::from_faces(std::move(vertices), body.faces);
}

constexpr std::size_t steps = 32;

double now() { return 1e9 * thread_seconds(); }  // [ns]

template <class Query>
double nanoseconds(const Query& query) {
  double best = infinity;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double begin = now();
    for (std::size_t k = 0; k < steps; ++k) query(k);
    best = std::min(best, (now() - begin) / static_cast<double>(steps));
  }
  return best;
}

/// By category: all pairs in the order of the file, the best of some rounds.
std::map<std::string, double> fresh_times(const std::vector<CorpusPair>& pairs, ConvexMethod method) {
  std::vector<std::array<ConvexHull, 2>> hulls;
  for (const CorpusPair& p : pairs) hulls.push_back({hull_of(p.a, 1.0).hull, hull_of(p.b, 1.0).hull});
  std::map<std::string, double> best;
  for (int round = 0; round < 7; ++round) {
    std::map<std::string, double> sum;
    for (std::size_t k = 0; k < pairs.size();) {
      const std::string& category = pairs[k].category;
      const double begin = now();
      for (; k < pairs.size() && pairs[k].category == category; ++k)
        ask(method, hulls[k][0].view(), hulls[k][1].view(), {pairs[k].a.centre, Quat(1, 0, 0, 0)},
            {pairs[k].b.centre, Quat(1, 0, 0, 0)});
      sum[category] += now() - begin;
    }
    for (const auto& [category, time] : sum)
      best[category] = best.count(category) ? std::min(best[category], time) : time;
  }
  return best;
}

/// Errors in units of the size; `off`: distance or normal worse than doubles allow (1e-12 size + 1e-15 of the
/// coordinates).
Row measure(const CorpusPair& p, ConvexMethod method, const Placing& at, bool timed) {
  Row row;
  row.pairs = 1;
  const auto &first = at.swapped ? p.b : p.a, &second = at.swapped ? p.a : p.b;
  const auto a = hull_of(first, at.scale), b = hull_of(second, at.scale);
  row.refused = !a.problem.empty() || !b.problem.empty();
  if (row.refused) return row;
  const Pose pose_a{at.turn * (at.scale * first.centre) + at.shift, at.turn};
  const Pose pose_b{at.turn * (at.scale * second.centre) + at.shift, at.turn};
  const PolyhedronView va = a.hull.view(), vb = b.hull.view();
  const ConvexAnswer d = ask(method, va, vb, pose_a, pose_b);
  if (timed) {
    ConvexAnswer last = d;
    PairMemory memory;
    row.cold = nanoseconds([&](std::size_t) { last = ask(method, va, vb, pose_a, pose_b); });
    Random random(1, 0);
    const std::vector<Pose> poses = p.moving_poses(steps, random);
    row.warm = nanoseconds([&](std::size_t k) { last = ask(method, va, vb, pose_a, poses[k], &memory); });
  }
  const double allowed = p.resolution() + 1e-15 * at.shift.norm() / at.scale;
  const double found = d.distance / at.scale;
  const Vec3 normal = at.turn.conjugate() * (at.swapped ? Vec3(-d.normal) : d.normal);
  const Vec3 between = pose_b.position - pose_a.position + d.witness_b - d.witness_a;
  row.distance = std::abs(found - p.distance) / p.size;
  row.regret = static_cast<double>(p.distance - p.separation(normal)) / p.size;
  row.witness = std::abs(between.dot(d.normal) / at.scale - p.distance) / p.size;
  row.wrong = std::abs(p.distance) > allowed && (found < 0) != (p.distance < 0);
  row.off = !(row.distance * p.size <= allowed && row.regret * p.size <= allowed);
  row.intervals = std::string(d.status) != "ok";
  return row;
}

int corpus(const char* path) {
  const std::vector<CorpusPair> pairs = read_corpus(path);
  std::map<std::string, Row> rows;
  Row whole;
  for (const auto& p : pairs) {
    const Row row = measure(p, ConvexMethod::automatic, {}, true);
    rows[p.category].add(row);
    whole.add(row);
  }
  for (const auto& [name, time] : fresh_times(pairs, ConvexMethod::automatic)) {
    rows[name].fresh = time;
    whole.fresh += time;
  }
  for (const auto& [name, row] : rows) row.print(name);
  whole.print("all");
  const auto total = [&](const std::string& name, ConvexMethod method, const Placing& at, bool timed) {
    Row sum;
    for (const auto& p : pairs) sum.add(measure(p, method, at, timed));
    sum.print(name);
    return sum.refused + sum.wrong + (method == ConvexMethod::automatic ? sum.off : 0);
  };
  int bad = whole.refused + whole.wrong + whole.off;
  bad += total("gjk-epa alone", ConvexMethod::gjk_epa, {}, true);
  total("sat alone", ConvexMethod::sat, {}, true);
  const Quat turn = Quat(Eigen::AngleAxisd(1.0, Vec3(1, 2, 3).normalized()));
  for (const Placing& at : {Placing{"scale 1e-6", 1e-6, Vec3::Zero(), Quat(1, 0, 0, 0), false},
                            {"scale 1e-3", 1e-3, Vec3::Zero(), Quat(1, 0, 0, 0), false},
                            {"scale 1e3", 1e3, Vec3::Zero(), Quat(1, 0, 0, 0), false},
                            {"scale 1e6", 1e6, Vec3::Zero(), Quat(1, 0, 0, 0), false},
                            {"turned by 1 rad", 1.0, Vec3(3, -2, 1), turn, false},
                            {"shifted by 1e6", 1.0, Vec3::Constant(1e6), Quat(1, 0, 0, 0), false},
                            {"swapped", 1.0, Vec3::Zero(), Quat(1, 0, 0, 0), true}}) {
    bad += total(std::string("auto, ") + at.name, ConvexMethod::automatic, at, false);
    bad += total(std::string("gjk-epa, ") + at.name, ConvexMethod::gjk_epa, at, false);
  }
  return pairs.empty() || bad > 0 ? 1 : 0;
}

/// Spheres on a cubic lattice that overlap their 6 neighbours and list the 12 edge neighbours as candidates. Error: the
/// gap.
int spheres() {
  constexpr std::uint32_t side = 22;
  constexpr double spacing = 0.99;
  ShapeStore shapes;
  World world;
  Body body;
  body.mass = 1.0;
  body.shape = shapes.add(Sphere{0.5}).packed;
  PairList list{{}, 0.0, 1};
  for (std::uint32_t s = 0; s < side * side * side; ++s) {
    const std::uint32_t i = s % side, j = s / side % side, k = s / side / side;
    body.position = spacing * Vec3(i, j, k);
    world.add(body);
    for (int di = -1; di <= 1; ++di) {
      for (std::uint32_t dj = 0; dj <= 1; ++dj) {
        for (std::uint32_t dk = 0; dk <= 1; ++dk) {
          const bool self = di == 0 && dj + dk == 0, back = di < 0 && dj + dk == 0, corner = di != 0 && dj + dk == 2;
          const std::uint32_t i2 = i + static_cast<std::uint32_t>(di);
          if (self || back || corner || i2 >= side || j + dj >= side || k + dk >= side) continue;
          list.pairs.push_back({s, i2 + side * (j + dj + side * (k + dk))});
        }
      }
    }
  }
  std::sort(list.pairs.begin(), list.pairs.end());
  set_thread_count(1);
  BatchNarrowPhase narrow(shapes, 0.0, true);
  ContactSet contacts;
  narrow.collide(world, list, contacts);
  using Clock = std::chrono::steady_clock;
  double best = infinity, error = 0.0;
  for (int repeat = 0; repeat < 50; ++repeat) {
    const auto begin = Clock::now();
    narrow.collide(world, list, contacts);
    best = std::min(best, std::chrono::duration<double, std::nano>(Clock::now() - begin).count());
  }
  for (const double gap : contacts.gap) error = std::max(error, std::abs(gap - (spacing - 1.0)));
  std::printf(
      "spheres: %zu bodies, %zu pairs, %zu contacts: %.1f ns per pair, %.1f ns per contact, worst gap error %.2e\n",
      world.size(), list.pairs.size(), contacts.size(), best / static_cast<double>(list.pairs.size()),
      best / static_cast<double>(contacts.size()), error);
  return error < 1e-14 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) { return argc < 2 ? spheres() : corpus(argv[1]); }
