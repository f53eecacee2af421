#include "laws/nonsmooth/warm_start.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "engine/state/contact_order.h"
#include "engine/threads/parallel_order.h"
#include "engine/units/registry.h"
#include "laws/nonsmooth/cone.h"

namespace epafi {

namespace {
constexpr std::uint32_t unmatched = 0xffffffffu;

Vec3 body_axes(const World& world, Slot s, const Vec3& x) {
  return world.has_orientation() ? Vec3(world.orientation[s].conjugate() * x) : x;
}
}  // namespace

/// First remembered contact of the pair, or the place where it would stand; guess: where it is at rest.
std::size_t WarmStart::find_pair(Slot a, Slot b, std::size_t guess) const {
  const auto is = [&](std::size_t k) { return a_[k] == a && b_[k] == b; };
  if (guess < a_.size() && is(guess) && (guess == 0 || !is(guess - 1))) return guess;
  std::size_t low = 0, high = a_.size();
  while (low < high) {
    const std::size_t mid = (low + high) / 2;
    if (std::tuple(a_[mid], b_[mid]) < std::tuple(a, b))
      low = mid + 1;
    else
      high = mid;
  }
  return low;
}

/// By key; then what is left of the pair on both sides, nearest first come.
void WarmStart::match_run(const World& world, const ContactSet& contacts, Run run) {
  const Slot a = contacts.a[run.begin], b = contacts.b[run.begin];
  const std::size_t first = find_pair(a, b, run.begin);
  std::size_t last = first;
  while (last < a_.size() && a_[last] == a && b_[last] == b) ++last;
  std::size_t old = first;
  std::uint32_t found = 0;
  for (std::uint32_t i = run.begin; i < run.end; ++i) {
    while (old < last && feature_[old] < contacts.feature[i]) ++old;
    const bool same = old < last && feature_[old] == contacts.feature[i];
    previous_[i] = same ? static_cast<std::uint32_t>(old) : unmatched;
    found += same;
  }
  if (found == last - first || found == run.end - run.begin) return;
  const auto taken = [&](std::size_t k) {
    const auto begin = previous_.begin() + run.begin, end = previous_.begin() + run.end;
    return std::any_of(begin, end, [&](std::uint32_t p) { return p == k; });
  };
  for (std::uint32_t i = run.begin; i < run.end; ++i) {
    if (previous_[i] != unmatched) continue;
    by_name_[i] = false;
    const Vec3 arm = body_axes(world, a, contacts.arm[i]);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = first; k < last; ++k) {
      const double distance = (arm_[k] - arm).squaredNorm();
      if (distance < nearest && !taken(k)) {
        nearest = distance;
        previous_[i] = static_cast<std::uint32_t>(k);
      }
    }
  }
}

void WarmStart::recall(const World& world, const ContactSet& contacts, const ContactProblem& problem, Impulses& r) {
  const auto begins = [&](std::size_t i) {
    return i == 0 || contacts.a[i] != contacts.a[i - 1] || contacts.b[i] != contacts.b[i - 1];
  };
  parallel_select(
      contacts.size(), begins, [](std::size_t i) { return static_cast<std::uint32_t>(i); }, runs_);
  renew(previous_, contacts.size());
  renew(r, contacts.size());
  parallel_fill(by_name_, contacts.size(), std::uint8_t{1});
  parallel_for(runs_.size(), [&](std::size_t k) {
    const Run run{runs_[k], k + 1 < runs_.size() ? runs_[k + 1] : static_cast<std::uint32_t>(contacts.size())};
    match_run(world, contacts, run);
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const bool known = previous_[i] != unmatched && problem.mobility[i] > 0.0;
      r[i] = known ? project_cone(problem.to_frame(i, impulse_[previous_[i]]), problem.friction[i]) : Vec3::Zero();
    }
  });
}

void WarmStart::remember(const World& world, const ContactSet& contacts, const ContactProblem& problem,
                         const Impulses& r, std::span<const double> next_gap, const std::vector<Vec3>& u) {
  const std::size_t n = contacts.size();
  renew(a_, n);
  renew(b_, n);
  renew(feature_, n);
  renew(gap_, n);
  renew(arm_, n);
  renew(impulse_, n);
  renew(slip_, n);
  parallel_for(n, [&](std::size_t i) {
    a_[i] = contacts.a[i];
    b_[i] = contacts.b[i];
    feature_[i] = contacts.feature[i];
    gap_[i] = next_gap[i];
    arm_[i] = body_axes(world, a_[i], contacts.arm[i]);
    impulse_[i] = problem.to_world(i, r[i]);
    slip_[i] = problem.to_world(i, {0.0, u[i].y(), u[i].z()});
  });
}

bool WarmStart::same() const {
  if (previous_.size() != a_.size()) return false;
  return block_max<char>(previous_.size(), 0,
                         [&](std::size_t i) { return static_cast<char>(previous_[i] != i || !by_name_[i]); }) == 0;
}

double WarmStart::predicted_gap(std::size_t i) const {
  const std::uint32_t k = previous_[i];
  return k == unmatched || !by_name_[i] || impulse_[k].isZero(0.0) ? -infinity : gap_[k];
}

std::optional<Vec3> WarmStart::slip(std::size_t i) const {
  const std::uint32_t k = previous_[i];
  return k == unmatched || !by_name_[i] || impulse_[k].isZero(0.0) ? std::nullopt : std::optional(slip_[k]);
}

void WarmStart::reorder(const Reordering& change) {
  const std::vector<std::uint32_t> order = order_after(change, a_, b_, feature_);
  permute(order, a_, b_, feature_, arm_, impulse_, gap_, slip_);
}

void WarmStart::visit(StateVisitor& visitor) {
  visitor.column("warm_start/a", a_);
  visitor.column("warm_start/b", b_);
  visitor.column("warm_start/feature", feature_);
  visitor.column("warm_start/arm", arm_);
  visitor.column("warm_start/impulse", impulse_);
  visitor.column("warm_start/gap", gap_);
  visitor.column("warm_start/slip", slip_);
}

}  // namespace epafi
