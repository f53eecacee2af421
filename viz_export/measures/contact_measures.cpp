#include "viz_export/measures/contact_measures.h"

#include <algorithm>
#include <limits>

#include "engine/state/large_column.h"
#include "engine/threads/parallel_order.h"

namespace epafi {

ContactMeasure::ContactMeasure(MeasureSetup setup) : setup_(std::move(setup)) {
  for (std::size_t g = 0; g < 2; ++g)
    for (std::size_t k = 0; k < setup_.bodies[g].size(); ++k) {
      const auto id = static_cast<std::size_t>(setup_.bodies[g][k]);
      if (side_.size() <= id) side_.resize(id + 1, 0);
      side_[id] = static_cast<char>(side_[id] | (g == 0 ? 1 : 2));
    }
}

void ContactMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const auto side = [&](Slot s) {
    const auto id = static_cast<std::size_t>(w.id[s]);
    return id < side_.size() ? side_[id] : char{0};
  };
  const ContactSet c = view.pieces().wanted([&](Slot s, Slot t) {
    const char a = side(s), b = side(t);
    return (a & 1 && b & 2) || (a & 2 && b & 1);
  });
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  values = {0, 0, 0, 0, nan, nan, nan, 0};
  double deepest = 0;
  for (std::size_t k = 0; k < c.size(); ++k) {
    const double normal_force = -c.force[k].dot(c.normal[k]);
    if (c.gap[k] >= 0 && normal_force == 0) continue;
    values[1] += normal_force;
    values[2] += (c.force[k] + normal_force * c.normal[k]).norm();
    values[7] += 1;
    if (values[7] > 1 && -c.gap[k] <= deepest) continue;
    deepest = -c.gap[k];
    Vec3 slip = w.velocity[c.b[k]] - w.velocity[c.a[k]];
    if (w.rotates())
      slip += w.angular_velocity[c.b[k]].cross(c.arm_b(k, w)) - w.angular_velocity[c.a[k]].cross(c.arm[k]);
    slip -= slip.dot(c.normal[k]) * c.normal[k];
    const Vec3 p = c.point(k, w);
    values[0] = std::max(0.0, deepest);
    values[3] = slip.norm();
    values[4] = p.x();
    values[5] = p.y();
    values[6] = p.z();
  }
}

namespace {

/// Neighbours in contact: those of a free body s are list[begin[s]] to list[end[s]], each once, whatever the order of
/// its contacts (two clumps may touch by many balls).
struct Neighbours {
  UnwrittenColumn<std::uint32_t> begin, end;
  UnwrittenColumn<Slot> list;
  void find(const World& world, const ContactPieces& contacts) {
    const auto acts = [](const ContactSet& c, std::size_t k) {
      return c.gap[k] < 0 || (k < c.force.size() && c.force[k].squaredNorm() > 0);
    };
    const auto each = [&](std::size_t first, std::size_t last, const auto& f) {
      const auto note = [&](const ContactSet& c, std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k)
          if (acts(c, k)) {
            f(c.a[k], c.b[k]);
            f(c.b[k], c.a[k]);
          }
      };
      for (std::size_t piece = first; piece < last; ++piece)
        if (contacts.is_own(piece) && !contacts.all_touching(piece))
          contacts.read(piece, note);  // adhesion acts across gaps
        else
          contacts.read_gaps(piece, note);
    };
    parallel_group(
        contacts.size(), world.size(), begin, each, [&](std::size_t count) { list.resize(count); },
        [&](std::uint32_t place, Slot other) { list[place] = other; }, 4);
    end.resize(world.size());
    parallel_for(world.size(), [&](std::size_t s) {
      const auto first = list.begin() + begin[s], last = list.begin() + begin[s + 1];
      if (world.is_movable(static_cast<Slot>(s))) std::sort(first, last);
      end[s] = static_cast<std::uint32_t>(std::unique(first, last) - list.begin());
    });
  }
};

constexpr int gone = -1;

/// Repeatedly removes bodies with fewer than `least` neighbours. The rest does not depend on the order (k-core of a
/// graph: Seidman 1983). Each thread has its own bodies, at least 4096; removals that concern bodies of other threads
/// are applied in the next round.
class Rattlers {
 public:
  /// degree: input: number of neighbours, `gone` for other bodies; output: number of remaining ones, `gone` for removed
  /// bodies.
  Rattlers(const Neighbours& touched, double least, UnwrittenColumn<int>& degree)
      : touched_(touched), least_(least), degree_(degree) {
    constexpr std::size_t grain = 4096;
    const SharedOut meter(degree.size() >= 2 * grain);
    parts_.resize(std::clamp<std::size_t>(degree.size() / grain, 1, static_cast<std::size_t>(thread_count())));
    each_part([&](Part& mine, Slot begin, Slot end) {
      for (Slot s = begin; s < end; ++s)
        if (degree_[s] != gone && degree_[s] < least_) mine.leaving.push_back(s);
      take_away(mine, begin, end);
    });
    while (pass_on())
      each_part([&](Part& mine, Slot begin, Slot end) {
        for (const Part& other : parts_)
          for (const Slot s : other.told)
            if (s >= begin && s < end) lose_one(mine, s);
        take_away(mine, begin, end);
      });
  }

 private:
  struct alignas(64) Part {
    std::vector<Slot> leaving;     ///< of its own
    std::vector<Slot> tell, told;  ///< of others, once for each neighbour that left: in this round, in the one before
  };

  template <class F>
  void each_part(const F& f) {
    const std::size_t n = degree_.size(), parts = parts_.size();
    parallel_blocks(parts, 1, [&](std::size_t p, std::size_t, std::size_t) {
      f(parts_[p], static_cast<Slot>(n * p / parts), static_cast<Slot>(n * (p + 1) / parts));
    });
  }
  void lose_one(Part& mine, Slot s) {
    if (degree_[s] != gone && degree_[s]-- == least_) mine.leaving.push_back(s);
  }
  void take_away(Part& mine, Slot begin, Slot end) {
    while (!mine.leaving.empty()) {
      const Slot s = mine.leaving.back();
      mine.leaving.pop_back();
      degree_[s] = gone;
      for (std::uint32_t k = touched_.begin[s]; k < touched_.end[s]; ++k) {
        const Slot other = touched_.list[k];
        if (other >= begin && other < end)
          lose_one(mine, other);
        else
          mine.tell.push_back(other);
      }
    }
  }
  bool pass_on() {
    bool any = false;
    for (Part& p : parts_) {
      p.told.swap(p.tell);
      p.tell.clear();
      any = any || !p.told.empty();
    }
    return any;
  }

  const Neighbours& touched_;
  double least_;
  UnwrittenColumn<int>& degree_;
  std::vector<Part> parts_;
};

/// Number of remaining bodies and the sum of their degrees; integers, exact in any order.
Sum3 count_left(const UnwrittenColumn<int>& degree) {
  return block_sum<Sum3>(degree.size(), [&](std::size_t s) {
    return degree[s] == gone ? Sum3{} : Sum3{1.0, static_cast<double>(degree[s]), 0.0};
  });
}

}  // namespace

void Coordination::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  // kept, since allocating 3 MB for 100 000 spheres at every sample would dominate the serial part
  thread_local Neighbours kept;
  thread_local UnwrittenColumn<int> kept_degree;
  Neighbours& touched = kept;  // of the caller
  UnwrittenColumn<int>& degree = kept_degree;
  touched.find(w, view.pieces());
  degree.resize(w.size());
  parallel_for(w.size(), [&](std::size_t s) {
    const bool is_body = w.is_movable(static_cast<Slot>(s));
    degree[s] = is_body ? static_cast<int>(touched.end[s] - touched.begin[s]) : gone;
  });
  const Sum3 all = count_left(degree);
  const Rattlers taken(touched, least_, degree);
  const Sum3 left = count_left(degree);
  values = {all.a > 0 ? all.b / all.a : 0.0, left.a > 0 ? left.b / left.a : 0.0, all.a - left.a};
}

}  // namespace epafi
