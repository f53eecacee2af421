#include "laws/nonsmooth/sweep_slices.h"

#include <algorithm>
#include <cstring>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {

/// f(column) for all columns of a slice, of whatever rows.
template <class S, class F>
void each_column(S& slice, const F& f) {
  auto& p = slice.problem;
  f(p.inverse_mass);
  f(p.inverse_inertia);
  f(p.frame);
  f(p.arm_a);
  f(p.arm_b);
  f(p.friction);
  f(p.offset);
  f(p.lag);
  f(p.diagonal);
  f(slice.r);
  f(slice.v.linear);
  f(slice.v.angular);
  f(slice.groups);
  f(slice.color_begin);
}

class Writer {
 public:
  RankMessages::Bytes bytes;
  template <class T>
  void value(const T& x) {
    put(&x, sizeof x);
  }
  template <class Column>
  void column(const Column& x) {
    value(x.size());
    put(x.data(), x.size() * sizeof x[0]);
  }

 private:
  void put(const void* from, std::size_t n) {
    const std::size_t at = bytes.size();
    bytes.resize(at + n);
    if (n > 0) std::memcpy(bytes.data() + at, from, n);
  }
};

class Reader {
 public:
  explicit Reader(const RankMessages::Bytes& bytes) : bytes_(bytes) {}
  template <class T>
  T value() {
    T x{};
    take(&x, sizeof x);
    return x;
  }
  template <class Column>
  void column(Column& x) {
    x.resize(value<std::size_t>());
    take(static_cast<void*>(x.data()), x.size() * sizeof x[0]);
  }

 private:
  void take(void* to, std::size_t n) {
    if (n > 0) std::memcpy(to, bytes_.data() + at_, n);
    at_ += n;
  }
  const RankMessages::Bytes& bytes_;
  std::size_t at_ = 0;
};

void write_borders(Writer& writer, const std::vector<std::vector<Border>>& colors) {
  for (const auto& borders : colors) {
    writer.value(borders.size());
    for (const Border& border : borders) {
      writer.value(border.rank);
      writer.column(border.bodies);
    }
  }
}

std::vector<std::vector<Border>> read_borders(Reader& reader, std::size_t colors) {
  std::vector<std::vector<Border>> all(colors);
  for (auto& borders : all) {
    borders.resize(reader.value<std::size_t>());
    for (Border& border : borders) {
      border.rank = reader.value<int>();
      reader.column(border.bodies);
    }
  }
  return all;
}

/// A body of the whole problem in a slice.
struct Use {
  Slot slot;
  int rank;
  std::uint32_t place;
};

class Cutter {
 public:
  Cutter(const ContactProblem& problem, int ranks, const BodyVelocities& v, const Impulses& r)
      : problem_(problem), coloring_(problem.coloring()), v_(v), r_(r), ranks_(static_cast<std::size_t>(ranks)) {}

  SlicedProblem cut() {
    out_.slices.resize(ranks_);
    out_.contacts.resize(ranks_);
    share_groups();
    for (std::size_t k = 0; k < ranks_; ++k) take_groups(k);
    std::ranges::sort(uses_, {}, [](const Use& u) { return std::pair(u.slot, u.rank); });
    find_borders();
    parallel_for(
        ranks_, [&](std::size_t k) { fill(k); }, 1);
    return std::move(out_);
  }

 private:
  /// A pair belongs to its first body that can move: slots are in the order of places in space.
  Slot home(const ContactGroup& g) const { return problem_.is_free(g.a) ? g.a : g.b; }

  /// Runs of slots with as many contacts.
  void share_groups() {
    std::vector<std::size_t> count(problem_.inverse_mass.size() + 1, 0);
    for (const ContactGroup& g : coloring_.groups()) count[home(g) + 1] += g.count;
    for (std::size_t s = 1; s < count.size(); ++s) count[s] += count[s - 1];
    rank_.resize(coloring_.groups().size());
    const std::size_t all = std::max<std::size_t>(1, count.back());
    for (std::size_t g = 0; g < rank_.size(); ++g)
      rank_[g] = static_cast<int>(std::min(ranks_ - 1, count[home(coloring_.groups()[g])] * ranks_ / all));
  }

  /// Of slice k: its groups with places of their own, its contacts and bodies.
  void take_groups(std::size_t k) {
    SweepSlice& slice = out_.slices[k];
    place_.resize(problem_.inverse_mass.size(), unplaced);
    bodies_.emplace_back();
    const auto place = [&](Slot s) {
      if (place_[s] == unplaced) {
        place_[s] = static_cast<std::uint32_t>(bodies_[k].size());
        bodies_[k].push_back(s);
        if (problem_.is_free(s)) uses_.push_back({s, static_cast<int>(k), place_[s]});
      }
      return static_cast<Slot>(place_[s]);
    };
    for (std::size_t c = 0; c < coloring_.colors(); ++c) {
      slice.color_begin.push_back(slice.groups.size());
      for (std::size_t g = coloring_.begin(c); g < coloring_.begin(c + 1); ++g) {
        if (rank_[g] != static_cast<int>(k)) continue;
        const ContactGroup& from = coloring_.groups()[g];
        const auto first = static_cast<std::uint32_t>(out_.contacts[k].size());
        slice.groups.push_back({place(from.a), place(from.b), first, from.count});
        for (std::uint32_t i = 0; i < from.count; ++i) out_.contacts[k].push_back(from.first + i);
      }
    }
    slice.color_begin.push_back(slice.groups.size());
    for (const Slot s : bodies_[k]) place_[s] = unplaced;
  }

  /// What a pair changes of bodies that other slices have too.
  void find_borders() {
    for (SweepSlice& slice : out_.slices) {
      slice.out.resize(coloring_.colors());
      slice.in.resize(coloring_.colors());
    }
    for (std::size_t c = 0; c < coloring_.colors(); ++c)
      for (std::size_t g = coloring_.begin(c); g < coloring_.begin(c + 1); ++g)
        for (const Slot s : {coloring_.groups()[g].a, coloring_.groups()[g].b})
          if (problem_.is_free(s)) tell_of(s, rank_[g], c);
  }

  void tell_of(Slot s, int from, std::size_t color) {
    const auto first = std::ranges::lower_bound(uses_, s, {}, &Use::slot);
    const auto last = std::ranges::upper_bound(uses_, s, {}, &Use::slot);
    const auto mine = std::ranges::find(first, last, from, &Use::rank);
    for (auto use = first; use != last; ++use) {
      if (use->rank == from) continue;
      border(out_.slices[static_cast<std::size_t>(from)].out[color], use->rank).push_back(mine->place);
      border(out_.slices[static_cast<std::size_t>(use->rank)].in[color], from).push_back(use->place);
    }
  }

  static std::vector<std::uint32_t>& border(std::vector<Border>& all, int rank) {
    const auto found = std::ranges::find(all, rank, &Border::rank);
    return found != all.end() ? found->bodies : all.emplace_back(Border{rank, {}}).bodies;
  }

  void fill(std::size_t k) {
    SweepSlice& slice = out_.slices[k];
    ContactProblem& p = slice.problem;
    p.rotates = problem_.rotates;
    const auto take = [](const auto& from, auto& to, const auto& which) {
      if (from.empty()) return;
      to.resize(which.size());
      for (std::size_t i = 0; i < which.size(); ++i) to[i] = from[which[i]];
    };
    const auto& contacts = out_.contacts[k];
    take(problem_.inverse_mass, p.inverse_mass, bodies_[k]);
    take(problem_.inverse_inertia, p.inverse_inertia, bodies_[k]);
    take(v_.linear, slice.v.linear, bodies_[k]);
    take(v_.angular, slice.v.angular, bodies_[k]);
    take(problem_.frame, p.frame, contacts);
    take(problem_.arm_a, p.arm_a, contacts);
    take(problem_.arm_b, p.arm_b, contacts);
    take(problem_.friction, p.friction, contacts);
    take(problem_.offset, p.offset, contacts);
    take(problem_.lag, p.lag, contacts);
    take(problem_.diagonal, p.diagonal, contacts);
    take(r_, slice.r, contacts);
  }

  static constexpr std::uint32_t unplaced = 0xffffffffu;
  const ContactProblem& problem_;
  const Coloring& coloring_;
  const BodyVelocities& v_;
  const Impulses& r_;
  std::size_t ranks_;
  SlicedProblem out_;
  std::vector<int> rank_;                  ///< of each group of the whole
  std::vector<std::uint32_t> place_;       ///< by slot: in the slice at work
  std::vector<std::vector<Slot>> bodies_;  ///< of each slice
  std::vector<Use> uses_;
};

}  // namespace

RankMessages::Bytes SweepSlice::packed() const {
  Writer writer;
  writer.value(problem.rotates);
  each_column(*this, [&](const auto& column) { writer.column(column); });
  write_borders(writer, out);
  write_borders(writer, in);
  return std::move(writer.bytes);
}

SweepSlice SweepSlice::unpacked(const RankMessages::Bytes& bytes) {
  SweepSlice slice;
  Reader reader(bytes);
  slice.problem.rotates = reader.value<bool>();
  each_column(slice, [&](auto& column) { reader.column(column); });
  slice.out = read_borders(reader, slice.color_begin.size() - 1);
  slice.in = read_borders(reader, slice.color_begin.size() - 1);
  return slice;
}

SlicedProblem cut_for_sweeps(const ContactProblem& problem, int ranks, const BodyVelocities& v, const Impulses& r) {
  return Cutter(problem, ranks, v, r).cut();
}

}  // namespace epafi
