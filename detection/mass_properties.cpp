#include "detection/mass_properties.h"

#include <cmath>

#include "detection/aabb.h"

namespace epafi {
namespace {

Mat3 inertia_of_second_moment(const Mat3& c) { return c.trace() * Mat3::Identity() - c; }

/// One Jacobi rotation that makes m(p, q) vanish (Golub and Van Loan 2013, section 8.5); the angle is at most 45
/// degrees.
void annihilate(Mat3& m, Mat3& axes, int p, int q) {
  const double tau = (m(q, q) - m(p, p)) / (2.0 * m(p, q));
  const double t = (tau >= 0.0 ? 1.0 : -1.0) / (std::abs(tau) + std::sqrt(1.0 + tau * tau));
  const double c = 1.0 / std::sqrt(1.0 + t * t), s = t * c;
  Mat3 turn = Mat3::Identity();
  turn(p, p) = turn(q, q) = c;
  turn(p, q) = s;
  turn(q, p) = -s;
  m = turn.transpose() * m * turn;
  m(p, q) = m(q, p) = 0.0;
  axes = axes * turn;
}

/// The proper signed permutation of the columns with the largest trace: least turn away from the author's axes.
Mat3 nearest_naming(const Mat3& axes, std::array<int, 3>& order) {
  constexpr std::array<std::array<int, 3>, 6> permutations{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
  Mat3 best = axes;
  double best_trace = -4.0;
  for (std::size_t k = 0; k < permutations.size(); ++k) {
    for (int signs = 0; signs < 8; ++signs) {
      const int flips = (signs & 1) + (signs >> 1 & 1) + (signs >> 2 & 1);
      if ((flips % 2 == 1) != (k >= 3)) continue;  // the last three permutations are odd
      Mat3 named;
      for (int j = 0; j < 3; ++j)
        named.col(j) = (signs >> j & 1 ? -1.0 : 1.0) * axes.col(permutations[k][static_cast<std::size_t>(j)]);
      if (named.trace() <= best_trace + 1e-12) continue;  // ties go to the first
      best = named;
      best_trace = named.trace();
      order = permutations[k];
    }
  }
  return best;
}

}  // namespace

MassProperties surface_mass_properties(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  Aabb box;
  for (const auto& t : triangles)
    for (const auto v : t) box.include(vertices[v]);
  if (triangles.empty()) return {};
  const Vec3 apex = box.centre();
  double six_volumes = 0.0;
  Vec3 first = Vec3::Zero();   // 24 times the integral of x
  Mat3 second = Mat3::Zero();  // 120 times the integral of x x^T
  for (const auto& t : triangles) {
    const Vec3 a = vertices[t[0]] - apex, b = vertices[t[1]] - apex, c = vertices[t[2]] - apex;
    const double det = a.dot(b.cross(c));
    const Vec3 sum = a + b + c;
    six_volumes += det;
    first += det * sum;
    second += det * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  const double volume = six_volumes / 6.0;
  if (volume == 0.0) return {0.0, apex, Mat3::Zero()};
  const Vec3 centre = first / (24.0 * volume);
  const Mat3 about_centre = second / 120.0 - volume * centre * centre.transpose();
  return {volume, apex + centre, inertia_of_second_moment(about_centre)};
}

Mat3 inertia_about_origin(const MassProperties& body) {
  return body.inertia + body.mass * inertia_of_second_moment(body.centre * body.centre.transpose());
}

PrincipalFrame principal_frame(const MassProperties& body) {
  Mat3 m = 0.5 * (body.inertia + body.inertia.transpose());
  Mat3 axes = Mat3::Identity();
  const double negligible =
      1e-13 * std::abs(m.trace());            // rounding of the sums above; also what a cube's diagonals leave
  for (int sweep = 0; sweep < 16; ++sweep) {  // quadratic convergence: 4 to 5 sweeps are enough
    if (std::abs(m(0, 1)) <= negligible && std::abs(m(0, 2)) <= negligible && std::abs(m(1, 2)) <= negligible) break;
    for (const auto& [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}})
      if (std::abs(m(p, q)) > 1e-4 * negligible) annihilate(m, axes, p, q);
  }
  std::array<int, 3> order{0, 1, 2};
  const Mat3 named = nearest_naming(axes, order);
  PrincipalFrame frame;
  frame.centre = body.centre;
  if (named != Mat3::Identity()) frame.orientation = Quat(named).normalized();
  for (int j = 0; j < 3; ++j)
    frame.moments[j] = m(order[static_cast<std::size_t>(j)], order[static_cast<std::size_t>(j)]);
  return frame;
}

}  // namespace epafi
