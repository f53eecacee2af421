#include "laws/nonsmooth/even_pressure.h"

#include <algorithm>
#include <tuple>

#include "laws/factors.h"
#include "laws/nonsmooth/cone.h"

namespace epafi {

namespace {

constexpr std::size_t most_bodies = 8;  // beside a wall: the work grows with the cube
constexpr double noticed = 1e-2;        // of all normal impulses

bool is_closed(const ContactProblem& problem, std::uint32_t i, double gap_rate, const Impulses& r, double touching) {
  return problem.mobility[i] > 0.0 && (r[i].x() > 0.0 || gap_rate <= touching);
}

/// The shortest r >= 0 with the given G^T r, by steps to the shortest r of the loaded rows.
Eigen::VectorXd shortest(const Eigen::MatrixXd& g, Eigen::VectorXd r) {
  constexpr int rounds = 4;
  constexpr double weight = 1e-12;  // of the Gram matrix: displacements that close no contact
  const Eigen::Index n = r.size();
  std::vector<char> bears(static_cast<std::size_t>(n), 1);
  for (int round = 0; round < rounds; ++round) {
    Eigen::MatrixXd rows = g;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!bears[static_cast<std::size_t>(i)]) rows.row(i).setZero();
    Eigen::MatrixXd gram = transposed_product(rows, rows);
    gram.diagonal().array() += weight * (gram.trace() / static_cast<double>(gram.rows()) + 1e-300);
    const Eigen::VectorXd change = rows * solve_ldlt(gram, rows.transpose() * r) - r;
    double share = 1.0;
    Eigen::Index first = -1;
    for (Eigen::Index i = 0; i < n; ++i)
      if (bears[static_cast<std::size_t>(i)] && change(i) < 0.0 && r(i) + share * change(i) < 0.0) {
        share = -r(i) / change(i);
        first = i;
      }
    for (Eigen::Index i = 0; i < n; ++i)
      if (bears[static_cast<std::size_t>(i)]) r(i) += share * change(i);
    if (first < 0) break;
    r(first) = 0.0;
    bears[static_cast<std::size_t>(first)] = 0;
  }
  return r;
}

}  // namespace

/// The walls, and free bodies joined to them by closed contacts, nearest first.
void EvenPressure::reach(const ContactProblem& problem, const std::vector<Vec3>& u, double touching,
                         const Impulses& r) {
  column_.assign(problem.inverse_mass.size(), -1);
  bodies_.clear();
  columns_ = 0;
  const auto add = [&](Slot s, int width) {
    if (column_[s] >= 0) return;
    column_[s] = columns_;
    columns_ += width;
    bodies_.push_back(s);
  };
  for (const Guide& guide : problem.guides) add(guide.slot, 1);
  const std::size_t most = bodies_.size() + most_bodies;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Slot s = bodies_[k];
    problem.incidence.for_each(s, [&](std::uint32_t i, double as_a) {
      const Slot other = as_a > 0.0 ? problem.b[i] : problem.a[i];
      if (bodies_.size() < most && problem.is_free(other) && is_closed(problem, i, u[i].x(), r, touching))
        add(other, 6);
    });
  }
}

/// Closed contacts whose bodies are all among them, or fixed.
void EvenPressure::collect(const ContactProblem& problem, const std::vector<Vec3>& u, double touching,
                           const Impulses& r) {
  reach(problem, u, touching, r);
  contacts_.clear();
  for (const Slot s : bodies_)
    problem.incidence.for_each(s, [&](std::uint32_t i, double) {
      if (!is_closed(problem, i, u[i].x(), r, touching)) return;
      const auto counts = [&](Slot body) { return !problem.is_free(body) || column_[body] >= 0; };
      if (counts(problem.a[i]) && counts(problem.b[i])) contacts_.push_back(i);
    });
  std::sort(contacts_.begin(), contacts_.end());
  contacts_.erase(std::unique(contacts_.begin(), contacts_.end()), contacts_.end());
}

/// G: opening of the contacts by displacements and rotations of the bodies, columns of length 1.
EvenPressure::Matrix EvenPressure::displacements(const ContactProblem& problem) const {
  Matrix g = Matrix::Zero(static_cast<Eigen::Index>(contacts_.size()), columns_);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const std::uint32_t i = contacts_[k];
    const Vec3& normal = problem.frame[i].normal;
    for (const auto& [slot, sign, arm] :
         {std::tuple(problem.a[i], -1.0, &problem.arm_a[i]), std::tuple(problem.b[i], 1.0, &problem.arm_b[i])}) {
      const int column = column_[slot];
      if (column < 0) continue;
      const auto guide = std::find_if(problem.guides.begin(), problem.guides.end(),
                                      [s = slot](const Guide& wall) { return wall.slot == s; });
      auto row = g.row(static_cast<Eigen::Index>(k));
      if (guide != problem.guides.end()) {
        row(column) += sign * guide->direction.dot(normal);
      } else {
        row.segment<3>(column) += sign * normal.transpose();
        row.segment<3>(column + 3) += sign * arm->cross(normal).transpose();
      }
    }
  }
  for (Eigen::Index c = 0; c < g.cols(); ++c)
    if (const double length = g.col(c).norm(); length > 0.0) g.col(c) /= length;
  return g;
}

/// The new normal impulses, and the friction of each pair in proportion to them.
void EvenPressure::share_friction(const ContactProblem& problem, const Vector& normal, Impulses& r) const {
  for (std::size_t first = 0, last = 0; first < contacts_.size(); first = last) {
    const std::uint32_t of = contacts_[first];
    Vec3 friction = Vec3::Zero();
    double sum = 0.0;
    for (last = first; last < contacts_.size(); ++last) {
      const std::uint32_t i = contacts_[last];
      if (problem.a[i] != problem.a[of] || problem.b[i] != problem.b[of]) break;
      friction += problem.to_world(i, {0.0, r[i].y(), r[i].z()});
      sum += normal(static_cast<Eigen::Index>(last));
    }
    for (std::size_t k = first; k < last; ++k) {
      const std::uint32_t i = contacts_[k];
      const double load = normal(static_cast<Eigen::Index>(k));
      Vec3 part = problem.to_frame(i, sum > 0.0 ? Vec3(load / sum * friction) : Vec3(Vec3::Zero()));
      part.x() = load;
      r[i] = project_disk(part, problem.friction[i] * load);
    }
  }
}

bool EvenPressure::apply(const ContactProblem& problem, const std::vector<Vec3>& u, double touching, Impulses& r) {
  collect(problem, u, touching, r);
  if (contacts_.empty()) return false;
  Vector normal(static_cast<Eigen::Index>(contacts_.size()));
  for (std::size_t k = 0; k < contacts_.size(); ++k) normal(static_cast<Eigen::Index>(k)) = r[contacts_[k]].x();
  const Vector even = shortest(displacements(problem), normal);
  if (!((even - normal).norm() > noticed * normal.norm())) return false;
  share_friction(problem, even, r);
  return true;
}

}  // namespace epafi
