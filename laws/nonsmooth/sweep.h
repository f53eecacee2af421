/// @file sweep.h  Coloured block Gauss-Seidel sweeps in body space, over data packed in the order it is read. One
/// contact update reads u from the velocities of two bodies, asks the local rule for a new r and applies the change.
/// Pairs are coloured, not contacts: both bodies stay in registers over the points of a manifold. Colours run in
/// sequence, pairs of a colour in parallel; the bits do not depend on the number of threads. Rates: perf/solvers.cpp.
#pragma once
#include <type_traits>

#include "engine/threads/order_free_sum.h"
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

/// A local rule: what of W_ii it keeps, and r from u of one contact.
template <class R>
concept LocalRule = requires(const R& rule, typename R::Data& data, const Mat3& block, double mu, const Vec3& r,
                             const Vec3& u) {
  { R::pack(block) } -> std::same_as<typename R::Data>;
  { rule.update(data, mu, r, u) } -> std::same_as<Vec3>;
};

template <bool Rotates, LocalRule Rule>
class Sweep {
 public:
  /// Packs the problem; velocities start as v (those of r).
  void load(const ContactProblem& problem, const Impulses& r, const BodyVelocities& v) {
    coloring_ = &problem.coloring();
    load_bodies(problem, v);
    const auto groups = coloring_->groups();
    groups_.resize(groups.size());
    change_.resize(groups.size());
    std::uint32_t next = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      groups_[g] = {groups[g].a, groups[g].b, next, next + groups[g].count, groups[g].first};
      next += groups[g].count;
    }
    rows_.resize(next);
    parallel_for(groups_.size(), [&](std::size_t g) {
      for (std::uint32_t k = groups_[g].begin; k < groups_[g].end; ++k)
        load_row(problem, groups_[g].first + k - groups_[g].begin, r, rows_[k]);
    });
  }

  /// One update of every contact; returns the sum of |change of r|^2.
  double run(const Rule& rule) {
    for (std::size_t c = 0; c < coloring_->colors(); ++c) {
      const std::size_t begin = coloring_->begin(c), n = coloring_->begin(c + 1) - begin;
      const auto one = [&](std::size_t g) { change_[begin + g] = update_group(groups_[begin + g], rule); };
      if (coloring_->in_sequence(c)) {
        for (std::size_t g = 0; g < n; ++g) one(g);
      } else {
        parallel_for(n, one);
      }
    }
    return order_free_sum(change_);
  }

  void store(Impulses& r) const {
    r.resize(rows_.size());
    parallel_for(groups_.size(), [&](std::size_t g) {
      for (std::uint32_t k = groups_[g].begin; k < groups_[g].end; ++k)
        r[groups_[g].first + k - groups_[g].begin] = rows_[k].r;
    });
  }

  /// Velocity of body s after the sweeps so far.
  const Vec3& linear(Slot s) const { return bodies_[s].velocity; }
  const Vec3& angular(Slot s) const requires Rotates { return bodies_[s].angular_velocity; }

 private:
  struct Nothing {};
  struct Rotation {
    Vec3 angular_velocity;
    double inertia[6];  ///< inverse, xx yy zz xy xz yz
  };
  struct PackedBody : std::conditional_t<Rotates, Rotation, Nothing> {
    Vec3 velocity;
    double inverse_mass;
  };
  struct Arms {
    Vec3 arm_a, arm_b;
  };
  struct Row : std::conditional_t<Rotates, Arms, Nothing> {
    ContactFrame frame;
    Vec3 offset;
    double friction;
    Vec3 r;
    typename Rule::Data data;
  };
  struct Group {
    Slot a, b;
    std::uint32_t begin, end;  ///< rows
    std::uint32_t first;       ///< contact of row `begin`
  };

  void load_bodies(const ContactProblem& problem, const BodyVelocities& v) {
    bodies_.resize(problem.inverse_mass.size());
    parallel_for(bodies_.size(), [&](std::size_t s) {
      PackedBody& body = bodies_[s];
      body.velocity = v.linear[s];
      body.inverse_mass = problem.inverse_mass[s];
      if constexpr (Rotates) {
        const Mat3& j = problem.inverse_inertia[s];
        body.angular_velocity = v.angular[s];
        const double packed[6] = {j(0, 0), j(1, 1), j(2, 2), j(0, 1), j(0, 2), j(1, 2)};
        std::copy(packed, packed + 6, body.inertia);
      }
    });
  }

  static void load_row(const ContactProblem& problem, std::size_t i, const Impulses& r, Row& row) {
    row.frame = problem.frame[i];
    row.friction = problem.friction[i];
    row.offset =
        problem.lag.empty() ? Vec3(problem.offset[i], 0, 0) : Vec3(problem.lag[i] + Vec3(problem.offset[i], 0, 0));
    row.r = r[i];
    row.data = Rule::pack(problem.diagonal[i]);
    if constexpr (Rotates) {
      row.arm_a = problem.arm_a[i];
      row.arm_b = problem.arm_b[i];
    }
  }

  /// body += sign * M^-1 (impulse at arm).
  static void apply(PackedBody& body, const Vec3& impulse, double sign, const Vec3* arm) {
    body.velocity += (sign * body.inverse_mass) * impulse;
    if constexpr (Rotates) {
      const Vec3 m = arm->cross(impulse);
      const double* j = body.inertia;
      body.angular_velocity +=
          sign * Vec3(j[0] * m.x() + j[3] * m.y() + j[4] * m.z(), j[3] * m.x() + j[1] * m.y() + j[5] * m.z(),
                      j[4] * m.x() + j[5] * m.y() + j[2] * m.z());
    }
  }

  double update_group(const Group& group, const Rule& rule) {
    PackedBody a = bodies_[group.a], b = bodies_[group.b];
    double change = 0.0;
    for (std::uint32_t k = group.begin; k < group.end; ++k) {
      Row& row = rows_[k];
      Vec3 slip = b.velocity - a.velocity;
      if constexpr (Rotates) slip += b.angular_velocity.cross(row.arm_b) - a.angular_velocity.cross(row.arm_a);
      const ContactFrame& f = row.frame;
      const Vec3 u = row.offset + Vec3(f.normal.dot(slip), f.tangent1.dot(slip), f.tangent2.dot(slip));
      const Vec3 r = rule.update(row.data, row.friction, row.r, u);
      const Vec3 d = r - row.r;
      row.r = r;
      const Vec3 impulse = f.normal * d.x() + f.tangent1 * d.y() + f.tangent2 * d.z();
      const Vec3 *arm_a = nullptr, *arm_b = nullptr;
      if constexpr (Rotates) {
        arm_a = &row.arm_a;
        arm_b = &row.arm_b;
      }
      apply(a, impulse, -1.0, arm_a);
      apply(b, impulse, 1.0, arm_b);
      change += d.squaredNorm();
    }
    store_body(group.a, a);
    store_body(group.b, b);
    return change;
  }

  void store_body(Slot s, const PackedBody& body) {
    PackedBody& to = bodies_[s];
    if (to.inverse_mass <= 0.0) return;  // shared by the pairs of a colour, never written
    to.velocity = body.velocity;
    if constexpr (Rotates) to.angular_velocity = body.angular_velocity;
  }

  const Coloring* coloring_ = nullptr;
  std::vector<PackedBody> bodies_;
  std::vector<Row> rows_;
  std::vector<Group> groups_;
  std::vector<double> change_;
};

}  // namespace epafi
