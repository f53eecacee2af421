#include "laws/nonsmooth/shared_sweeps.h"

#include <algorithm>
#include <cstring>

#include "engine/ranks/rank_team.h"
#include "laws/nonsmooth/lane_sweep.h"
#include "laws/nonsmooth/solvers/pgs.h"
#include "laws/nonsmooth/sweep_slices.h"

namespace epafi {

namespace {

using Bytes = RankMessages::Bytes;

/// Sum of all processes' terms: the bits of order_free_sum over all of them together.
double sum_over_ranks(RankMessages& messages, std::span<const double> terms) {
  OrderFreeSum sum;
  for (std::size_t k = 0; k < terms.size(); k += sum_block)
    sum.add(terms.subspan(k, std::min(sum_block, terms.size() - k)));
  messages.join(sum);
  if (sum.in_range()) return sum.value();
  const auto* const first = reinterpret_cast<const std::byte*>(terms.data());
  const std::vector<Bytes> all = messages.gather(Bytes(first, first + terms.size_bytes()));
  ExactSum exact;
  for (const Bytes& bytes : all)
    for (std::size_t k = 0; k < bytes.size(); k += sizeof(double)) {
      double term = 0.0;
      std::memcpy(&term, bytes.data() + k, sizeof term);
      exact.add(term);
    }
  Bytes mine(sizeof(double));
  const double value = exact.value();
  std::memcpy(mine.data(), &value, sizeof value);
  Bytes came;
  messages.scatter(std::vector<Bytes>(messages.number() == 0 ? static_cast<std::size_t>(messages.count()) : 0, mine),
                   came);
  double result = 0.0;
  std::memcpy(&result, came.data(), sizeof result);
  return result;
}

/// The slice of one process.
template <bool Rotates>
class SliceSweep {
 public:
  SliceSweep(RankMessages& messages, SweepSlice& slice) : messages_(messages), slice_(slice) {
    coloring_.take(slice.groups, slice.color_begin);
    groups_.form(coloring_, static_cast<Slot>(slice.problem.inverse_mass.size()));
    sweep_.load(slice.problem, groups_, slice.problem.offset, slice.problem.lag, slice.r, slice.v);
  }

  /// The squared change of all impulses.
  double run(const PgsRule& rule) {
    for (std::size_t c = 0; c < coloring_.colors(); ++c) {
      sweep_.run_color(rule, c);
      exchange(c);
    }
    return sum_over_ranks(messages_, sweep_.changes());
  }
  double natural_map(double rho) { return std::sqrt(sum_over_ranks(messages_, sweep_.natural_squares(rho))); }
  void store(Impulses& r) const { sweep_.store(r); }

 private:
  /// Velocities: a row of Body begins with the angular one where there is one.
  static constexpr std::size_t row = (Rotates ? 2 : 1) * sizeof(Lanes);
  using Body = typename LaneSweep<Rotates, PgsRule>::Body;

  void exchange(std::size_t color) {
    const auto &out = slice_.out[color], &in = slice_.in[color];
    if (out.empty() && in.empty()) return;
    make_room(out, sent_, to_);
    make_room(in, come_, from_);
    for (std::size_t k = 0; k < out.size(); ++k)
      for (std::size_t i = 0; i < out[k].bodies.size(); ++i)
        put(sweep_.body(out[k].bodies[i]), to_[k].bytes.data() + i * row);
    messages_.exchange(to_, from_);
    for (std::size_t k = 0; k < in.size(); ++k)
      for (std::size_t i = 0; i < in[k].bodies.size(); ++i)
        take(sweep_.body(in[k].bodies[i]), from_[k].bytes.data() + i * row);
  }

  static void put(const Body& body, std::byte* to) {
    std::memcpy(to, &body.velocity, sizeof(Lanes));
    if constexpr (Rotates) std::memcpy(to + sizeof(Lanes), &body.angular_velocity, sizeof(Lanes));
  }
  static void take(Body& body, const std::byte* from) {
    std::memcpy(&body.velocity, from, sizeof(Lanes));
    if constexpr (Rotates) std::memcpy(&body.angular_velocity, from + sizeof(Lanes), sizeof(Lanes));
  }

  static void make_room(const std::vector<Border>& borders, Bytes& bytes, std::vector<RankMessages::Piece>& pieces) {
    std::size_t all = 0;
    for (const Border& border : borders) all += border.bodies.size() * row;
    bytes.resize(std::max(bytes.size(), all));
    pieces.clear();
    std::byte* at = bytes.data();
    for (const Border& border : borders) {
      pieces.push_back({border.rank, {at, border.bodies.size() * row}});
      at += border.bodies.size() * row;
    }
  }

  RankMessages& messages_;
  SweepSlice& slice_;
  Coloring coloring_;
  LaneGroups groups_;
  LaneSweep<Rotates, PgsRule> sweep_;
  Bytes sent_, come_;
  std::vector<RankMessages::Piece> to_, from_;
};

/// The same path in all processes: what decides on it are sums over all.
template <bool Rotates>
SolverReport sweep_slice(RankMessages& messages, SweepSlice& slice, const SweepStart& start) {
  SliceSweep<Rotates> sweep(messages, slice);
  const PgsRule rule{start.relaxation};
  const SolverReport report = sweep_until(
      start.limits, start.scale, [&](int) { return sweep.run(rule); },
      [&] { return sweep.natural_map(start.rho) / start.scale; }, [&] { return start.norm; }, [] { return false; });
  sweep.store(slice.r);
  return report;
}

/// A message: how to sweep, and what.
Bytes with_start(const SweepStart& start, const Bytes& slice) {
  Bytes all(sizeof start + slice.size());
  std::memcpy(all.data(), &start, sizeof start);
  std::ranges::copy(slice, all.begin() + sizeof start);
  return all;
}

SolverReport sweep_mine(RankMessages& messages, const std::vector<Bytes>& to, std::vector<Bytes>& impulses) {
  Bytes mine;
  messages.scatter(to, mine);
  SweepStart start;
  std::memcpy(&start, mine.data(), sizeof start);
  SweepSlice slice = SweepSlice::unpacked(Bytes(mine.begin() + sizeof start, mine.end()));
  const SolverReport report =
      slice.problem.rotates ? sweep_slice<true>(messages, slice, start) : sweep_slice<false>(messages, slice, start);
  const auto* const first = reinterpret_cast<const std::byte*>(slice.r.data());
  impulses = messages.gather(Bytes(first, first + slice.r.size() * sizeof(Vec3)));
  return report;
}

}  // namespace

std::optional<SolverReport> share_sweeps(RankMessages& messages, const ContactProblem& problem, const SweepStart& start,
                                         const BodyVelocities& v, Impulses& r) {
  const Coloring& coloring = problem.coloring();
  if (coloring.colors() == 0 || coloring.in_sequence(coloring.colors() - 1)) return std::nullopt;
  const SlicedProblem sliced = cut_for_sweeps(problem, messages.count(), v, r);
  std::vector<Bytes> to, impulses;
  for (const SweepSlice& slice : sliced.slices) to.push_back(with_start(start, slice.packed()));
  SolverReport report;
  messages.together([&] { report = sweep_mine(messages, to, impulses); });
  for (std::size_t k = 0; k < impulses.size(); ++k)
    for (std::size_t i = 0; i < sliced.contacts[k].size(); ++i)
      std::memcpy(r[sliced.contacts[k][i]].data(), impulses[k].data() + i * sizeof(Vec3), sizeof(Vec3));
  return report;
}

std::optional<SolverReport> share_sweeps(const ContactProblem& problem, const SweepStart& start,
                                         const BodyVelocities& v, Impulses& r) {
  RankTeam* const team = RankTeam::of_program();
  RankMessages* const messages = team != nullptr ? team->helpers() : nullptr;
  if (messages == nullptr || problem.size() < messages->least_contacts) return std::nullopt;
  return share_sweeps(*messages, problem, start, v, r);
}

void help_with_sweeps(RankMessages& messages) {
  std::vector<Bytes> none;
  sweep_mine(messages, {}, none);
}

}  // namespace epafi
