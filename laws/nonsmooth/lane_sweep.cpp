#include "laws/nonsmooth/lane_sweep.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/lanes/targets.h"
#include "engine/threads/order_free_sum.h"
#include "engine/threads/parallel_order.h"
#include "engine/threads/parallel_stages.h"
#include "laws/nonsmooth/normal_rule.h"
#include "laws/nonsmooth/solvers/nsgs.h"
#include "laws/nonsmooth/solvers/pgs.h"
#include "laws/nonsmooth/solvers/soft_step.h"

namespace epafi {

namespace {

/// Four bodies side by side.
template <bool Rotates, class Rule>
struct FourBodies {
  using Body = typename LaneSweep<Rotates, Rule>::Body;
  Lanes3 velocity, angular_velocity;
  Lanes inverse_mass, xx, yy, zz, xy, xz, yz;

  EPAFI_LANES void gather(const Body* bodies, const std::array<Slot, lane_count>& s) {
    const Body &p = bodies[s[0]], &q = bodies[s[1]], &m = bodies[s[2]], &n = bodies[s[3]];
    load(p.velocity, q.velocity, m.velocity, n.velocity, velocity.x, velocity.y, velocity.z, inverse_mass);
    if constexpr (Rotates) {
      Lanes none;
      load(p.angular_velocity, q.angular_velocity, m.angular_velocity, n.angular_velocity, angular_velocity.x,
           angular_velocity.y, angular_velocity.z, none);
      load(p.inertia_diagonal, q.inertia_diagonal, m.inertia_diagonal, n.inertia_diagonal, xx, yy, zz, none);
      load(p.inertia_rest, q.inertia_rest, m.inertia_rest, n.inertia_rest, xy, xz, yz, none);
    }
  }
  EPAFI_LANES static void load(Lanes p, Lanes q, Lanes m, Lanes n, Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
    transpose(p, q, m, n);
    a = p;
    b = q;
    c = m;
    d = n;
  }

  /// Bodies that cannot move are shared by the pairs of a colour and never written.
  EPAFI_LANES void scatter(Body* bodies, const std::array<Slot, lane_count>& s) const {
    Lanes v[lane_count] = {velocity.x, velocity.y, velocity.z, inverse_mass};
    transpose(v[0], v[1], v[2], v[3]);
    Lanes w[lane_count] = {};
    if constexpr (Rotates) {
      w[0] = angular_velocity.x;
      w[1] = angular_velocity.y;
      w[2] = angular_velocity.z;
      transpose(w[0], w[1], w[2], w[3]);
    }
    for (std::size_t l = 0; l < lane_count; ++l) {
      if (!(inverse_mass[l] > 0.0)) continue;
      bodies[s[l]].velocity = v[l];
      if constexpr (Rotates) bodies[s[l]].angular_velocity = w[l];
    }
  }

  EPAFI_LANES void apply(const Lanes3& impulse, const Lanes3* arm) {
    velocity = velocity + inverse_mass * impulse;
    if constexpr (Rotates) {
      const Lanes3 m = arm->cross(impulse);
      angular_velocity = angular_velocity + Lanes3{xx * m.x + xy * m.y + xz * m.z, xy * m.x + yy * m.y + yz * m.z,
                                                   xz * m.x + yz * m.y + zz * m.z};
    }
  }
};

/// u = H^T v + w.
template <bool Rotates, class Rule>
EPAFI_LANES void velocities(const typename LaneSweep<Rotates, Rule>::Row& row, const FourBodies<Rotates, Rule>& a,
                            const FourBodies<Rotates, Rule>& b, Lanes (&u)[Rule::rows]) {
  Lanes3 slip = b.velocity - a.velocity;
  if constexpr (Rotates) slip = slip + b.angular_velocity.cross(row.arm_b) - a.angular_velocity.cross(row.arm_a);
  for (int i = 0; i < Rule::rows; ++i) u[i] = row.offset[i] + row.axis[i].dot(slip);
}

/// The squared natural map of some groups (cone.h), by pairs: which pairs are together in a group must not matter.
template <bool Rotates, class Rule>
struct NaturalMapTask {
  using Sweep = LaneSweep<Rotates, Rule>;
  const LaneGroup *begin, *end;
  const typename Sweep::Row* rows;
  const typename Sweep::Body* bodies;
  double* out;
  double rho;

  EPAFI_LANES void run() const {
    double* to = out;
    for (const auto* group = begin; group != end; ++group) {
      FourBodies<Rotates, Rule> a, b;
      a.gather(bodies, group->a);
      b.gather(bodies, group->b);
      Lanes sum{};
      for (std::uint32_t k = group->begin; k < group->end; ++k) sum += of_row(rows[k], a, b);
      std::memcpy(to, &sum, sizeof sum);
      to += lane_count;
    }
  }

  EPAFI_LANES Lanes of_row(const typename Sweep::Row& row, const FourBodies<Rotates, Rule>& a,
                           const FourBodies<Rotates, Rule>& b) const {
    Lanes u[3];
    velocities<Rotates, Rule>(row, a, b, u);
    const Lanes mu = row.friction, slip = sqrt(u[1] * u[1] + u[2] * u[2]);
    const Lanes n = row.r[0] - rho * (u[0] + mu * slip), t1 = row.r[1] - rho * u[1], t2 = row.r[2] - rho * u[2];
    const Lanes t = sqrt(t1 * t1 + t2 * t2), foot = (n + mu * t) / (1.0 + mu * mu);
    const LaneMask inside = (n >= Lanes{}) & (t <= mu * n), polar = mu * t <= -n;
    const Lanes on = select(inside, n, foot), scale = select(inside, lanes(1.0), mu * foot / max(t, lanes(1e-300)));
    const Lanes d0 = row.r[0] - select(polar, Lanes{}, on), d1 = row.r[1] - select(polar, Lanes{}, scale * t1),
                d2 = row.r[2] - select(polar, Lanes{}, scale * t2);
    return select(row.data.step_n > Lanes{}, d0 * d0 + d1 * d1 + d2 * d2, Lanes{});
  }
};

/// Some groups of one stage, one after the other.
template <bool Rotates, class Rule>
struct ColorTask {
  using Sweep = LaneSweep<Rotates, Rule>;
  const LaneGroup *begin, *end, *last;  ///< of the stage, most likely also done by this thread
  typename Sweep::Row* rows;
  typename Sweep::Body* bodies;
  double* change;  ///< by pairs
  Rule rule;

  EPAFI_LANES void run() const {
    double* out = change;
    for (const auto* group = begin; group != end; ++group) {
      if (last - group > ahead) ask_for(group[ahead]);
      const Lanes sum = update(*group);
      std::memcpy(out, &sum, sizeof sum);
      out += lane_count;
    }
  }

  /// Prefetches bodies of a later group, which are scattered over their column: 5000 stones take 28.4 instead of 30.8
  /// ms a step, with two threads 16.1 instead of 18.8. One to four groups ahead are equal.
  static constexpr std::ptrdiff_t ahead = 2;
  EPAFI_LANES void ask_for(const LaneGroup& group) const {
    for (const auto* slots : {&group.a, &group.b})
      for (const Slot s : *slots)
        for (std::size_t line = 0; line < sizeof(typename Sweep::Body); line += 64)
          __builtin_prefetch(reinterpret_cast<const char*>(&bodies[s]) + line);
  }

  EPAFI_LANES Lanes update(const LaneGroup& group) const {
    FourBodies<Rotates, Rule> a, b;
    a.gather(bodies, group.a);
    b.gather(bodies, group.b);
    Lanes sum{};
    for (std::uint32_t k = group.begin; k < group.end; ++k) update(rows[k], a, b, sum);
    a.scatter(bodies, group.a);
    b.scatter(bodies, group.b);
    return sum;
  }

  EPAFI_LANES void update(typename Sweep::Row& row, FourBodies<Rotates, Rule>& a, FourBodies<Rotates, Rule>& b,
                          Lanes& sum) const {
    Lanes u[Rule::rows], r[Rule::rows];
    velocities<Rotates, Rule>(row, a, b, u);
    for (int i = 0; i < Rule::rows; ++i) r[i] = row.r[i];
    rule.update(row.data, row.friction, r, u);
    Lanes3 impulse{};
    for (int i = 0; i < Rule::rows; ++i) {
      const Lanes d = r[i] - row.r[i];
      row.r[i] = r[i];
      impulse = impulse + d * row.axis[i];
      sum += d * d;
    }
    const Lanes3 *arm_a = nullptr, *arm_b = nullptr;
    if constexpr (Rotates) {
      arm_a = &row.arm_a;
      arm_b = &row.arm_b;
    }
    a.apply(-impulse, arm_a);
    b.apply(impulse, arm_b);
  }
};

/// By AVX2 at most: with AVX-512 four lanes are no faster (pile of 500 stones 2.02 s, so 1.98).
template <class Task>
void run_four(const Task& task) {
  if (target() == Target::baseline)
    run_apart<2>(task);
  else
    run_apart<4>(task);
}

void set(Lanes3& to, std::size_t lane, const Vec3& x) {
  to.x[lane] = x.x();
  to.y[lane] = x.y();
  to.z[lane] = x.z();
}

template <class Row, class Rule>
void load_lane(const ContactProblem& problem, std::size_t i, double offset, const Vec3* lag, const Vec3& r,
               std::size_t lane, Row& row) {
  const Vec3* axes[] = {&problem.frame[i].normal, &problem.frame[i].tangent1, &problem.frame[i].tangent2};
  for (int k = 0; k < Rule::rows; ++k) {
    set(row.axis[k], lane, *axes[k]);
    row.offset[k][lane] = (lag != nullptr ? (*lag)[k] : 0.0) + (k == 0 ? offset : 0.0);
    row.r[k][lane] = r[k];
  }
  row.friction[lane] = problem.friction[i];
  Rule::pack(problem, i, row.data, lane);
  if constexpr (requires { row.arm_a; }) {
    set(row.arm_a, lane, problem.arm_a[i]);
    set(row.arm_b, lane, problem.arm_b[i]);
  }
}

}  // namespace

/// True if several threads are faster: half of the sweep takes longer than the waits between its stages. (8 large
/// spheres among 8000 small ones, two threads: contacts of a step 0.72 ms with this test, 0.93 without; one thread
/// 0.63.)
bool LaneLoops::pays() const {
  constexpr double stage = 1e-6;  // 0.5 to 2.5 us, depending on the latency between processors
  if (groups_->shared() == 0) return false;
  const double part = static_cast<double>(groups_->shared()) / static_cast<double>(groups_->size());
  return 0.5 * part * row_time_ * static_cast<double>(groups_->rows()) >
         stage * static_cast<double>(groups_->stages() + 1);
}

double LaneLoops::run_stages(const Body& body, bool measured) {
  const LaneGroup* const groups = groups_->data();
  const std::size_t stages = groups_->stages();
  const std::span<const double> changes(change_.data(), change_.size());
  sums_.assign(measured ? (changes.size() + sum_block - 1) / sum_block : 0, {});
  const auto sum = [&](std::size_t k) {
    sums_[k].add(changes.subspan(k * sum_block, std::min(sum_block, changes.size() - k * sum_block)));
  };
  // part of the last stage: a separate loop would take 7 of 180 us (5000 stones, two threads)
  parallel_stages(
      stages + std::size_t{measured}, pays(),
      [&](std::size_t s) { return s < stages ? groups_->size(s) : sums_.size(); },
      [&](std::size_t s) { return s < stages ? groups_->piece(s) : 1; },
      [&](std::size_t s, std::size_t b, std::size_t e) {
        if (s < stages) {
          const LaneGroup* const first = groups + groups_->begin(s);
          return body(first + b, first + e, groups + groups_->begin(s + 1));
        }
        for (std::size_t k = b; k < e; ++k) sum(k);
      });
  OrderFreeSum total;
  for (const OrderFreeSum& part : sums_) total += part;
  return measured ? value_of(total, changes.size(), [&](std::size_t i) { return changes[i]; }) : 0.0;
}

void LaneLoops::run_groups(std::size_t first, std::size_t last, const Body& body) const {
  const LaneGroup* const groups = groups_->data();
  parallel_blocks(last - first, LaneGroups::grain, [&](std::size_t b, std::size_t e, std::size_t) {
    body(groups + first + b, groups + first + e, groups + last);
  });
}

template <bool Rotates, LaneRule Rule>
void LaneSweep<Rotates, Rule>::load(const ContactProblem& problem, const LaneGroups& groups,
                                    std::span<const double> offset, std::span<const Vec3> lag, const Impulses& r,
                                    const BodyVelocities& v) {
  load_bodies(problem, v);
  groups_ = &groups;
  renew(rows_, groups_->rows());
  renew(change_, lane_count * groups_->size());
  const auto fill = [&](const LaneGroup& group) {
    for (std::uint32_t k = group.begin; k < group.end; ++k) {
      if (const auto least = *std::min_element(group.count.begin(), group.count.end()); k - group.begin >= least)
        rows_[k] = Row{};
      for (std::size_t lane = 0; lane < lane_count; ++lane)
        if (const std::size_t i = group.first[lane] + k - group.begin; k - group.begin < group.count[lane])
          load_lane<Row, Rule>(problem, i, offset[i], lag.empty() ? nullptr : &lag[i], r[i], lane, rows_[k]);
    }
  };
  groups_->each(pays(), std::ref(fill));  // by reference: no allocation
}

template <bool Rotates, LaneRule Rule>
void LaneSweep<Rotates, Rule>::load_bodies(const ContactProblem& problem, const BodyVelocities& v) {
  const std::size_t n = problem.inverse_mass.size();
  renew(bodies_, n + 1);
  bodies_[n] = Body{};
  parallel_for(n, [&](std::size_t s) {
    Body& body = bodies_[s];
    const Vec3& x = v.linear[s];
    body.velocity = Lanes{x.x(), x.y(), x.z(), problem.inverse_mass[s]};
    if constexpr (Rotates) {
      const Vec3& w = v.angular[s];
      const Mat3& j = problem.inverse_inertia[s];
      body.angular_velocity = Lanes{w.x(), w.y(), w.z(), 0.0};
      body.inertia_diagonal = Lanes{j(0, 0), j(1, 1), j(2, 2), 0.0};
      body.inertia_rest = Lanes{j(0, 1), j(0, 2), j(1, 2), 0.0};
    }
  });
}

template <bool Rotates, LaneRule Rule>
LaneLoops::Body LaneSweep<Rotates, Rule>::task(const Rule& rule) {
  return [this, &rule](const LaneGroup* begin, const LaneGroup* end, const LaneGroup* last) {
    run_four(ColorTask<Rotates, Rule>{begin, end, last, rows_.data(), bodies_.data(),
                                      change_.data() + lane_count * (begin - groups_->data()), rule});
  };
}

template <bool Rotates, LaneRule Rule>
double LaneSweep<Rotates, Rule>::run(const Rule& rule, bool measured) {
  return run_stages(task(rule), measured);
}

template <bool Rotates, LaneRule Rule>
void LaneSweep<Rotates, Rule>::store(Impulses& r) const {
  groups_->each(pays(), [&](const LaneGroup& group) {
    for (std::size_t lane = 0; lane < lane_count; ++lane)
      for (std::uint32_t k = 0; k < group.count[lane]; ++k)
        for (int i = 0; i < Rule::rows; ++i) r[group.first[lane] + k][i] = rows_[group.begin + k].r[i][lane];
  });
}

template <bool Rotates, LaneRule Rule>
void LaneSweep<Rotates, Rule>::run_color(const Rule& rule, std::size_t color) {
  run_groups(groups_->color_begin(color), groups_->color_begin(color + 1), task(rule));
}

template <bool Rotates, LaneRule Rule>
std::span<const double> LaneSweep<Rotates, Rule>::natural_squares(double rho) const requires(Rule::rows == 3) {
  if constexpr (Rule::rows == 3) {  // Clang 14: see angular()
    renew(squares_, lane_count * groups_->size());
    run_groups(0, groups_->size(), [this, &rho](const LaneGroup* begin, const LaneGroup* end, const LaneGroup*) {
      run_four(NaturalMapTask<Rotates, Rule>{begin, end, rows_.data(), bodies_.data(),
                                             squares_.data() + lane_count * (begin - groups_->data()), rho});
    });
  }
  return {squares_.data(), squares_.size()};
}

template <bool Rotates, LaneRule Rule>
double LaneSweep<Rotates, Rule>::natural_map(double rho) const requires(Rule::rows == 3) {
  if constexpr (Rule::rows == 3) return std::sqrt(order_free_sum(natural_squares(rho)));
  return 0.0;
}

template <bool Rotates, LaneRule Rule>
void LaneSweep<Rotates, Rule>::add(const BodyVelocities& v) {
  parallel_for(v.linear.size(), [&](std::size_t s) {
    for (int k = 0; k < 3; ++k) {
      bodies_[s].velocity[k] += v.linear[s][k];
      if constexpr (Rotates) bodies_[s].angular_velocity[k] += v.angular[s][k];
    }
  });
}

template class LaneSweep<true, SoftRule>;
template class LaneSweep<false, SoftRule>;
template class LaneSweep<true, PgsRule>;
template class LaneSweep<false, PgsRule>;
template class LaneSweep<true, NsgsRule>;
template class LaneSweep<false, NsgsRule>;
template class LaneSweep<true, NormalRule>;
template class LaneSweep<false, NormalRule>;

}  // namespace epafi
