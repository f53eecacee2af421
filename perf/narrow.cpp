/// @file narrow.cpp  Convex pairs with exact answers: time and error of the narrow phase.
/// perf_narrow: ns per candidate pair of spheres through the whole narrow phase, one thread.
/// perf_narrow CORPUS [--pairs]: per category ns per cold query, failures, wrong classes, worst errors in units of the size.
#include <chrono>
#include <cstdio>
#include <map>

#include "detection/narrow/narrow_phase.h"
#include "detection/narrow/polyhedra.h"
#include "engine/parallel.h"
#include "tests/support/convex_corpus.h"

using namespace epafi;

namespace {

struct Row {
  int pairs = 0, refused = 0, wrong = 0, iterations = 0;
  double nanoseconds = 0.0, distance = 0.0, regret = 0.0, witness = 0.0;
  void add(const Row& o) {
    pairs += o.pairs, refused += o.refused, wrong += o.wrong, iterations = std::max(iterations, o.iterations);
    nanoseconds += o.nanoseconds, distance = std::max(distance, o.distance);
    regret = std::max(regret, o.regret), witness = std::max(witness, o.witness);
  }
  void print(const char* name) const {
    std::printf("%-20s %5d pairs %8.0f ns  refused %d  wrong class %d  distance %.2e  regret %.2e  witness %.2e\n", name, pairs,
                nanoseconds / pairs, refused, wrong, distance, regret, witness);
  }
};

/// Rounding that no method in doubles can avoid: eps of the coordinates.
double allowance(const support::CorpusPair& p) {
  const double reach = (p.b.centre - p.a.centre).norm();
  double largest = reach;
  for (const auto* body : {&p.a, &p.b}) {
    for (const Vec3& v : body->vertices) largest = std::max(largest, v.norm());
  }
  return 1e-12 * p.size + 1e-15 * std::max(largest, std::max(p.a.centre.norm(), p.b.centre.norm()));
}

Row measure(const support::CorpusPair& p, bool verbose) {
  Row row;
  row.pairs = 1;
  const auto a = ConvexHull::from_faces(p.a.vertices, p.a.faces), b = ConvexHull::from_faces(p.b.vertices, p.b.faces);
  if (!a.problem.empty() || !b.problem.empty()) {
    row.refused = 1;
    if (verbose) std::printf("refused: %s: %s %s\n", p.category.c_str(), a.problem.c_str(), b.problem.c_str());
    return row;
  }
  const Pose pose_a{p.a.centre, Quat(1, 0, 0, 0)}, pose_b{p.b.centre, Quat(1, 0, 0, 0)};
  PolyhedronDistance d;
  using Clock = std::chrono::steady_clock;
  double best = infinity;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto begin = Clock::now();
    for (int k = 0; k < 8; ++k) d = polyhedron_distance({a.hull.view(), b.hull.view(), pose_a, pose_b});
    best = std::min(best, std::chrono::duration<double, std::nano>(Clock::now() - begin).count() / 8);
  }
  row.nanoseconds = best;
  const double allowed = allowance(p);
  row.distance = std::abs(d.axis.gap - p.distance) / p.size;
  row.regret = static_cast<double>(p.distance - p.separation(d.axis.normal)) / p.size;
  row.witness = std::abs((d.witness_b - d.witness_a).dot(d.axis.normal) - p.distance) / p.size;
  row.wrong = std::abs(p.distance) > allowed && (d.axis.gap < 0) != (p.distance < 0);
  const bool bad = row.wrong || row.distance * p.size > allowed || row.regret * p.size > allowed || !(row.distance < 1e300);
  if (verbose && bad) {
    std::printf("bad: %s size %.3g exact %.17g found %.17g (error/allowed %.3g, regret/allowed %.3g) kind %d\n", p.category.c_str(), p.size,
                p.distance, d.axis.gap, row.distance * p.size / allowed, row.regret * p.size / allowed, static_cast<int>(d.axis.kind));
  }
  return row;
}

/// Spheres on a cubic lattice that overlap their 6 neighbours and list the 12 edge neighbours as candidates. Error: the gap.
int spheres() {
  constexpr std::uint32_t side = 22;
  constexpr double spacing = 0.99;
  ShapeStore shapes;
  World world;
  Body body;
  body.mass = 1.0, body.shape = shapes.add(Sphere{0.5}).packed;
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
  std::printf("spheres: %zu bodies, %zu pairs, %zu contacts: %.1f ns per pair, %.1f ns per contact, worst gap error %.2e\n", world.size(),
              list.pairs.size(), contacts.size(), best / static_cast<double>(list.pairs.size()), best / static_cast<double>(contacts.size()), error);
  return error < 1e-14 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return spheres();
  std::map<std::string, Row> rows;
  Row total;
  for (const auto& p : support::read_corpus(argv[1])) {
    const Row row = measure(p, argc > 2);
    rows[p.category].add(row), total.add(row);
  }
  for (const auto& [name, row] : rows) row.print(name.c_str());
  total.print("all");
  return total.pairs > 0 && total.refused == 0 && total.wrong == 0 ? 0 : 1;
}
