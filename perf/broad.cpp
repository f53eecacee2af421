/// @file broad.cpp  Broad phases on dense packs: every body drifts 1 % of its radius per step in a direction of its
/// own. Packs after reference harness practice: mono; lognormal 1:10; bimodal, 0.1 % boulders of 100 times the size in
/// their dust; decades, sizes 1:100 of equal volume per decade (case B11 d). Rows: mean and 99th percentile of ns per
/// body and step, pairs listed, pairs that touch (exact spheres), disagreements. Disagreement: touching pairs at the
/// last step that the list lacks, against the brute force of this file. Times are CPU seconds of the calling thread on
/// one thread, wall seconds on more (OMP_NUM_THREADS). Usage: perf_broad [bodies] [method] [scene]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <tuple>

#include "detection/broad/all_broad_phases.h"
#include "engine/threads/parallel.h"
#include "engine/units/random.h"
#include "scenes/processor_time.h"

using namespace epafi;

namespace {

struct Pack {
  World world;
  ShapeStore shapes;
  std::vector<double> radius;
};

double size_of(const char* kind, int i, int boulders, Random& random) {
  if (!std::strcmp(kind, "mono")) return 0.5;
  if (!std::strcmp(kind, "bimodal")) return i < boulders ? 50.0 : 0.5;
  // equal volume per decade: number per size falls with its fourth power
  if (!std::strcmp(kind, "decades")) return 0.5 / std::cbrt(1.0 - random.uniform() * (1.0 - 1e-6));
  const double normal = std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(2 * M_PI * random.uniform());
  return 0.5 * std::clamp(std::exp(0.45 * normal), 0.31623, 3.1623);
}

/// Bodies by descending size, each at the freest of up to 40 random places; dust within 4 radii of a boulder's surface.
class Packer {
 public:
  Packer(const char* kind, int n) : random_(7, 0) {
    const int boulders = std::strcmp(kind, "bimodal") ? 0 : std::max(1, n / 1000);
    double volume = 0.0;
    for (int i = 0; i < n; ++i) radius.push_back(size_of(kind, i, boulders, random_));
    std::sort(radius.begin(), radius.end(), std::greater<>());
    for (double r : radius) volume += 4.18879 * r * r * r;
    edge_ = std::cbrt(volume / (boulders ? 0.35 : 0.6));
    for (int i = 0; i < n; ++i) place(static_cast<std::size_t>(i), boulders);
  }
  std::vector<double> radius;
  std::vector<Vec3> position;

 private:
  using Cell = std::tuple<int, long, long, long>;
  Random random_;
  double edge_ = 0.0;
  std::map<int, std::map<Cell, std::vector<std::size_t>>> level_;

  static Cell cell(int level, const Vec3& x) {
    const double h = std::ldexp(1.0, level);
    return {level, std::lround(std::floor(x.x() / h)), std::lround(std::floor(x.y() / h)),
            std::lround(std::floor(x.z() / h))};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 d(random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1));
      if (d.norm() > 0.1 && d.norm() < 1) return d.normalized();
    }
  }
  /// Least centre distance over sum of radii.
  double freedom(double r, const Vec3& x) const {
    double least = 1e9;
    for (const auto& [l, cells] : level_) {
      const double reach = r + std::ldexp(1.0, l);
      const auto [k0, x0, y0, z0] = cell(l, x - Vec3::Constant(reach));
      const auto [k1, x1, y1, z1] = cell(l, x + Vec3::Constant(reach));
      for (long a = x0; a <= x1; ++a)
        for (long b = y0; b <= y1; ++b)
          for (long c = z0; c <= z1; ++c) {
            const auto found = cells.find({l, a, b, c});
            if (found == cells.end()) continue;
            for (std::size_t j : found->second) least = std::min(least, (x - position[j]).norm() / (r + radius[j]));
          }
    }
    return least;
  }
  void place(std::size_t i, int boulders) {
    Vec3 best = Vec3::Zero();
    double most = -1.0;
    for (int t = 0; t < 40 && most <= 0.75; ++t) {
      Vec3 x(random_.uniform(0, edge_), random_.uniform(0, edge_), random_.uniform(0, edge_));
      if (boulders && static_cast<int>(i) >= boulders) {
        const auto b = static_cast<std::size_t>(random_.bits() % static_cast<unsigned>(boulders));
        x = position[b] + (radius[b] + radius[i] * random_.uniform(1, 4)) * direction();
      }
      const double q = freedom(radius[i], x);
      if (q > most) {
        most = q;
        best = x;
      }
    }
    position.push_back(best);
    const int l = static_cast<int>(std::ceil(std::log2(2 * radius[i])));
    level_[l][cell(l, best)].push_back(i);
  }
};

Pack make_pack(const char* kind, int n) {
  const Packer packed(kind, n);
  std::vector<std::size_t> order(packed.radius.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  Random random(11, 0);
  for (std::size_t i = order.size(); i-- > 1;) std::swap(order[i], order[random.bits() % (i + 1)]);
  Pack pack;
  std::map<double, std::uint32_t> shape;
  for (std::size_t i : order) {
    const double r = packed.radius[i];
    if (!shape.count(r)) shape[r] = pack.shapes.add(Sphere{r}).packed;
    Vec3 d;
    do d = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    while (d.norm() < 0.1 || d.norm() > 1);
    Body body;
    body.position = packed.position[i];
    body.mass = r * r * r;
    body.shape = shape[r];
    body.velocity = 0.01 * r * d.normalized();
    pack.world.add(body);
  }
  pack.world.reorder(morton_order(pack.world));  // as a run does every so many steps
  for (std::uint32_t s : pack.world.shape) pack.radius.push_back(pack.shapes.bounding_radius({s}));
  return pack;
}

bool touch(const Pack& p, Slot i, Slot j) {
  const double sum = p.radius[i] + p.radius[j];
  return (p.world.position[i] - p.world.position[j]).squaredNorm() <= sum * sum;
}

std::vector<std::pair<Slot, Slot>> touching(const Pack& p, const PairList& list) {
  std::vector<std::pair<Slot, Slot>> out;
  for (const Pair& q : list.pairs)
    if (touch(p, q.a, q.b)) out.emplace_back(std::min(q.a, q.b), std::max(q.a, q.b));
  std::sort(out.begin(), out.end());
  return out;
}

/// Independent of the broad phases: all pairs whose x intervals meet, nothing kept.
std::vector<std::pair<Slot, Slot>> brute_touching(const Pack& p) {
  std::vector<Slot> order(p.radius.size());
  for (Slot s = 0; s < order.size(); ++s) order[s] = s;
  const auto low = [&](Slot s) { return p.world.position[s].x() - p.radius[s]; };
  std::sort(order.begin(), order.end(), [&](Slot a, Slot b) { return low(a) < low(b); });
  std::vector<std::pair<Slot, Slot>> out;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && low(order[j]) <= low(order[i]) + 2 * p.radius[order[i]] + 1e-9; ++j)
      if (touch(p, order[i], order[j])) out.emplace_back(std::min(order[i], order[j]), std::max(order[i], order[j]));
  std::sort(out.begin(), out.end());
  return out;
}

double seconds() { return seconds_of(thread_count() == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC); }

/// Moves the bodies and puts them back where they were.
void run(Pack& p, const char* kind, const std::string& method) {
  const std::size_t n = p.world.size();
  const int steps = n > 20000 ? 60 : 200;
  std::vector<Vec3> start;
  for (Slot s = 0; s < n; ++s) start.push_back(p.world.position[s]);
  const auto broad = make_broad_phase(method, BroadSetup{&p.shapes, 0.0, 0.0, {}}, p.world);
  PairList list;
  std::vector<double> nanoseconds;
  for (int k = -2; k < steps; ++k) {  // two calls to warm up and to learn dt
    p.world.time += 1.0;
    for (Slot s = 0; s < n; ++s) p.world.position[s] += p.world.velocity[s];
    const double t0 = seconds();
    broad->find_pairs(p.world, list);
    const double t1 = seconds();
    if (k >= 0) nanoseconds.push_back((t1 - t0) * 1e9 / static_cast<double>(n));
  }
  const auto found = touching(p, list), wanted = brute_touching(p);
  std::vector<std::pair<Slot, Slot>> wrong;
  std::set_symmetric_difference(found.begin(), found.end(), wanted.begin(), wanted.end(), std::back_inserter(wrong));
  double sum = 0.0;
  for (double t : nanoseconds) sum += t;
  std::sort(nanoseconds.begin(), nanoseconds.end());
  std::printf("%s,%zu,%s,%d,%.1f,%.1f,%.1f,%zu,%zu,%zu,%llu\n", kind, n, method.c_str(), thread_count(), sum / steps,
              nanoseconds[nanoseconds.size() / 2], nanoseconds[nanoseconds.size() * 99 / 100], list.pairs.size(),
              found.size(), wrong.size(), static_cast<unsigned long long>(list.generation));
  std::fflush(stdout);
  for (Slot s = 0; s < n; ++s) p.world.position[s] = start[s];
  p.world.time = 0.0;
}

}  // namespace

int main(int argc, char** argv) {
  const int only_n = argc > 1 ? std::atoi(argv[1]) : 0;
  const std::string only_method = argc > 2 ? argv[2] : "", only_kind = argc > 3 ? argv[3] : "";
  std::printf("scene,bodies,method,threads,ns_mean,ns_median,ns_p99,pairs_listed,touching,disagreements,builds\n");
  for (int n : {1000, 10000, 100000})
    for (const char* kind : {"mono", "lognormal", "bimodal", "decades"}) {
      if ((only_n && n != only_n) || (!only_kind.empty() && only_kind != kind)) continue;
      Pack pack = make_pack(kind, n);
      for (const auto& e : all_broad_phases()) {
        if (!only_method.empty() && e.entry.name != only_method) continue;
        if (n > 10000 && e.entry.name == "all-pairs") continue;
        run(pack, kind, e.entry.name);
      }
    }
}
