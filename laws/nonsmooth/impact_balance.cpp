#include "laws/nonsmooth/impact_balance.h"

#include <algorithm>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {
constexpr int most_solves = 8;           // of a step, to find s; then the lowest bound is used
constexpr double close_enough = 0.01;    // of the energy of the impact: accuracy of s
constexpr double clip_rounding = 1e-13;  // of the energy of the impact
constexpr double least_scale = 0.999;    // smaller scales are no matter of tolerance: bodies would sink
}  // namespace

void ImpactBalance::begin(std::size_t contacts) { bounces_.assign(contacts, {}); }

bool ImpactBalance::any() const {
  return block_max<char>(bounces_.size(), 0, [&](std::size_t i) { return char{bounces_[i].middle > 0.0}; }) != 0;
}

std::uint32_t ImpactBalance::root(std::uint32_t slot) {
  while (parent_[slot] != slot) slot = parent_[slot] = parent_[parent_[slot]];
  return slot;
}

/// Root of a free body of contact i; two free ones joined by an impulse have the same root.
std::uint32_t ImpactBalance::root_of(const ContactProblem& problem, std::size_t i) {
  return root(problem.is_free(problem.a[i]) ? problem.a[i] : problem.b[i]);
}

void ImpactBalance::find_islands(const Solved& solved) {
  const ContactProblem& p = solved.problem;
  parent_.resize(p.inverse_mass.size());
  for (std::uint32_t s = 0; s < parent_.size(); ++s) parent_[s] = s;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (solved.r[i].x() <= 0.0 || !p.is_free(p.a[i]) || !p.is_free(p.b[i])) continue;
    const std::uint32_t a = root(p.a[i]), b = root(p.b[i]);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  search_.assign(parent_.size(), {});
}

void ImpactBalance::measure(const Solved& solved) {
  const ContactProblem& p = solved.problem;
  islands_.assign(parent_.size(), {});
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3& r = solved.r[i];
    if (r.x() <= 0.0 || p.mobility[i] <= 0.0) continue;
    Island& island = islands_[root_of(p, i)];
    island.lost -= 0.5 * r.dot(solved.before[i] + solved.after[i]);
    island.response += r.dot(solved.after[i] - p.relative_velocity(i, p.free));
    const Bounce& bounce = bounces_[i];
    const double struck = r.x() * bounce.middle;
    if (struck <= 0.0) continue;
    island.struck += struck;
    island.owed += 0.5 * (1.0 - bounce.restitution) * struck;
    island.e = std::max(island.e, bounce.restitution);
  }
}

/// The next s: by the slope -e/2 that normal impulses have, then by the Illinois rule.
void ImpactBalance::advance(Search& search, const Island& island, double tolerance) const {
  const double excess = island.excess();
  const bool good = excess >= -tolerance;
  const bool last = search.solves++ >= most_solves;
  if (good) {
    search.low = search.s;
    search.at_low = std::max(excess, 0.0);
    search.at_high *= 0.5;
  } else {
    search.high = search.s;
    search.at_high = excess;
    search.at_low *= search.at_low > 0.0 ? 0.5 : 1.0;
  }
  search.settled = last || (good && (search.s == 1.0 || excess <= close_enough)) || search.s == 0.0;
  if (search.settled) return;
  double next = search.s + 2.0 * excess / std::max(island.e, 1e-3) - 0.1 * close_enough;
  if (search.at_low > 0.0)
    next = (search.low * search.at_high - search.high * search.at_low) / (search.at_high - search.at_low);
  const bool inside = next > search.low && next < search.high;
  search.s = search.solves >= most_solves ? search.low : inside ? next : 0.5 * (search.low + search.high);
}

bool ImpactBalance::tighten(const Solved& solved, double tolerance, ContactProblem& problem) {
  measure(solved);
  bool changed = false;
  for (std::uint32_t k = 0; k < search_.size(); ++k) {
    Search& search = search_[k];
    if (search.settled || islands_[k].struck <= 0.0) continue;
    const double before = search.s;
    advance(search, islands_[k], tolerance);
    changed = changed || search.s != before;
  }
  if (!changed) return false;
  for (std::size_t i = 0; i < bounces_.size(); ++i) {
    const Bounce& b = bounces_[i];
    if (b.middle <= 0.0) continue;
    const double s = search_[root_of(problem, i)].s;
    if (s < 1.0) problem.offset[i] = -std::max(0.0, s * b.restitution * b.middle - b.half);
  }
  return true;
}

/// Impulses a r change the energy by a r.u_m + a^2 r.W r/2, with u_m half a step of gravity after u-; this is 0 at a =
/// 1 + 2 lost / r.W r.
bool ImpactBalance::clip(const Solved& solved, Impulses& r) {
  find_islands(solved);
  measure(solved);
  bool any = false;
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (r[i].x() <= 0.0 || solved.problem.mobility[i] <= 0.0) continue;
    const Island& island = islands_[root_of(solved.problem, i)];
    if (!(island.struck > 0.0) || !(island.lost < -clip_rounding * island.struck)) continue;
    const double scale = 1.0 + 2.0 * island.lost / island.response;
    if (!(scale >= least_scale)) continue;
    r[i] *= scale;
    any = true;
  }
  return any;
}

}  // namespace epafi
