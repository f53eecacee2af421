/// @file gmres.h  Restarted GMRES (Saad and Schultz 1986) for an operator given as a function; sums in a fixed order.
#pragma once
#include <cmath>
#include <cstddef>
#include <vector>

namespace epafi {

/// By four sums, which the compiler puts into lanes.
inline double dot(const std::vector<double>& u, const std::vector<double>& v) {
  double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0;
  std::size_t i = 0;
  for (; i + 4 <= u.size(); i += 4) {
    s0 += u[i] * v[i];
    s1 += u[i + 1] * v[i + 1];
    s2 += u[i + 2] * v[i + 2];
    s3 += u[i + 3] * v[i + 3];
  }
  for (; i < u.size(); ++i) s0 += u[i] * v[i];
  return (s0 + s1) + (s2 + s3);
}

/// y of the upper triangle of H, by columns: the first k rows of H y = g.
inline std::vector<double> solve_triangle(const std::vector<std::vector<double>>& H, const std::vector<double>& g,
                                          std::size_t k) {
  std::vector<double> y(k);
  for (std::size_t i = k; i-- > 0;) {
    y[i] = g[i];
    for (std::size_t j = i + 1; j < k; ++j) y[i] -= H[j][i] * y[j];
    y[i] /= H[i][i];
  }
  return y;
}

/// Solves A x = b from x = 0 to a residual of `tolerance` |b|; apply(v, out) is out = A v. Returns the number of
/// products.
template <class Apply>
int gmres(const Apply& apply, const std::vector<double>& b, std::vector<double>& x, double tolerance, int restart,
          int most) {
  const std::size_t n = b.size();
  x.assign(n, 0.0);
  const double target = tolerance * std::sqrt(dot(b, b));
  std::vector<std::vector<double>> V;
  std::vector<double> r = b, w(n);
  int products = 0;
  for (double rest = std::sqrt(dot(r, r)); rest > target && products < most;) {
    const auto m = static_cast<std::size_t>(restart);
    std::vector<std::vector<double>> H(m, std::vector<double>(m + 1, 0.0));  // H[column][row]
    std::vector<double> g(m + 1, 0.0), cosine(m), sine(m);
    V.assign(1, r);
    for (double& v : V[0]) v /= rest;
    g[0] = rest;
    std::size_t k = 0;
    for (; k < m && products < most && std::abs(g[k]) > target; ++k) {
      apply(V[k], w);
      ++products;
      for (std::size_t i = 0; i <= k; ++i) {
        H[k][i] = dot(w, V[i]);
        for (std::size_t l = 0; l < n; ++l) w[l] -= H[k][i] * V[i][l];
      }
      H[k][k + 1] = std::sqrt(dot(w, w));
      if (H[k][k + 1] > 0.0)
        for (double& v : w) v /= H[k][k + 1];
      V.push_back(w);
      for (std::size_t i = 0; i < k; ++i) {
        const double t = cosine[i] * H[k][i] + sine[i] * H[k][i + 1];
        H[k][i + 1] = -sine[i] * H[k][i] + cosine[i] * H[k][i + 1];
        H[k][i] = t;
      }
      const double length = std::hypot(H[k][k], H[k][k + 1]);
      cosine[k] = H[k][k] / length;
      sine[k] = H[k][k + 1] / length;
      H[k][k] = length;
      g[k + 1] = -sine[k] * g[k];
      g[k] *= cosine[k];
    }
    const std::vector<double> y = solve_triangle(H, g, k);
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t l = 0; l < n; ++l) x[l] += y[i] * V[i][l];
    if (std::abs(g[k]) <= target) break;
    apply(x, w);
    for (std::size_t l = 0; l < n; ++l) r[l] = b[l] - w[l];
    rest = std::sqrt(dot(r, r));
  }
  return products;
}

}  // namespace epafi
