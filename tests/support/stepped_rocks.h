/// @file stepped_rocks.h  Surfaces of triangles as files have them, of boxes and of bodies made of cells: plates with
/// notches and holes, steps, rooms; and the convex bodies that they are made of.
#pragma once
#include <vector>

#include "detection/shapes/box.h"
#include "tests/support/random_geometry.h"

namespace epafi::support {

/// A rectangle as two triangles with corners of their own, cut along either diagonal.
inline void add_square(const std::array<Vec3, 4>& q, Random& random, TriangleSurface& out) {
  const std::size_t first = random.bits() & 1u;
  for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
    const auto at = static_cast<std::uint32_t>(out.vertices.size());
    for (const std::size_t c : {first, first + k, first + k + 1}) out.vertices.push_back(q[c % 4]);
    out.triangles.push_back({at, at + 1, at + 2});
  }
}

/// A table: every side in n by n squares.
inline TriangleSurface table_surface(const Vec3& half, int n, Random& random) {
  TriangleSurface s;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            Vec3 x;
            x[axis] = side * half[axis];
            x[(axis + 1) % 3] = half[(axis + 1) % 3] * (2.0 * (i + di) / n - 1.0);
            x[(axis + 2) % 3] = half[(axis + 2) % 3] * (2.0 * (j + dj) / n - 1.0);
            return x;
          };
          add_square({corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)}, random, s);
        }
  return s;
}

struct RockPart {
  Box box;
  Vec3 centre;
};

/// Cells of a lattice, some of them filled.
struct SteppedRock {
  std::array<int, 3> count;
  std::vector<bool> filled;
  Vec3 cell;  ///< [m]

  bool at(int i, int j, int k) const {
    if (i < 0 || j < 0 || k < 0 || i >= count[0] || j >= count[1] || k >= count[2]) return false;
    return filled[static_cast<std::size_t>((i * count[1] + j) * count[2] + k)];
  }
  Vec3 corner(int i, int j, int k) const { return cell.cwiseProduct(Vec3(i, j, k)); }
  Vec3 size() const { return corner(count[0], count[1], count[2]); }
  bool is_inside(const Vec3& x) const {
    const Vec3 place = x.cwiseQuotient(cell).array().floor();
    return at(static_cast<int>(place.x()), static_cast<int>(place.y()), static_cast<int>(place.z()));
  }
  /// At (i, j, k) two filled cells touch along an edge or at the corner only, or two empty ones do.
  bool is_pinched(int i, int j, int k) const {
    const auto cell_at = [&](int c) { return at(i - (c & 1), j - (c >> 1 & 1), k - (c >> 2 & 1)); };
    for (int c = 0; c < 8; ++c)
      for (const int face : {3, 5, 6}) {
        const int first = face & -face, second = face ^ first;
        if (cell_at(c) == cell_at(c ^ face) && cell_at(c ^ first) == cell_at(c ^ second) &&
            cell_at(c) != cell_at(c ^ first))
          return true;
      }
    for (int c = 0; c < 4; ++c) {
      const auto joins = [&](int one, int other) { return cell_at(one) == cell_at(c) && cell_at(other) == cell_at(c); };
      if (cell_at(c) != cell_at(c ^ 7)) continue;
      bool joined = false;
      for (const int first : {1, 2, 4})
        for (const int second : {1, 2, 4}) joined = joined || (first != second && joins(c ^ first, c ^ first ^ second));
      if (!joined) return true;
    }
    return false;
  }
};

/// Without places where the surface is no surface. share: of filled cells.
inline SteppedRock random_rock(Random& random, const std::array<int, 3>& count, double share = 0.75) {
  while (true) {
    SteppedRock p{count, {}, {}};
    p.cell = testing::random_point(random, 0.1, 0.3);
    int number = 0;
    for (int c = 0; c < count[0] * count[1] * count[2]; ++c) {
      p.filled.push_back(random.uniform() < share);
      number += p.filled.back();
    }
    bool pinched = number == 0;
    for (int i = 0; i <= count[0]; ++i)
      for (int j = 0; j <= count[1]; ++j)
        for (int k = 0; k <= count[2]; ++k) pinched = pinched || p.is_pinched(i, j, k);
    if (!pinched) return p;
  }
}

template <class F>
void each_cell(const std::array<int, 3>& low, const std::array<int, 3>& high, const F& f) {
  for (int i = low[0]; i < high[0]; ++i)
    for (int j = low[1]; j < high[1]; ++j)
      for (int k = low[2]; k < high[2]; ++k) f(std::array<int, 3>{i, j, k});
}

inline TriangleSurface surface_of(const SteppedRock& p, Random& random) {
  TriangleSurface s;
  each_cell({0, 0, 0}, p.count, [&](const std::array<int, 3>& c) {
    if (!p.at(c[0], c[1], c[2])) return;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        std::array<int, 3> next = c;
        next[axis] += 2 * side - 1;
        if (p.at(next[0], next[1], next[2])) continue;
        const auto corner = [&](int a, int b) {
          std::array<int, 3> at = c;
          at[axis] += side;
          at[(axis + 1) % 3] += side ? a : b;  // counter-clockwise seen from outside
          at[(axis + 2) % 3] += side ? b : a;
          return p.corner(at[0], at[1], at[2]);
        };
        add_square({corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)}, random, s);
      }
  });
  return s;
}

/// The largest boxes in the rock: a way out of it is a way out of all of them.
inline std::vector<RockPart> parts_of(const SteppedRock& p) {
  const auto all = [&](const std::array<int, 3>& low, const std::array<int, 3>& high) {
    bool full = true;
    each_cell(low, high, [&](const std::array<int, 3>& c) { full = full && p.at(c[0], c[1], c[2]); });
    return full;
  };
  const auto is_largest = [&](const std::array<int, 3>& low, const std::array<int, 3>& high) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto lower = low, higher = high;
      --lower[axis];
      ++higher[axis];
      if (all(lower, high) || all(low, higher)) return false;
    }
    return true;
  };
  std::vector<RockPart> out;
  each_cell({0, 0, 0}, p.count, [&](const std::array<int, 3>& low) {
    each_cell({low[0] + 1, low[1] + 1, low[2] + 1}, {p.count[0] + 1, p.count[1] + 1, p.count[2] + 1},
              [&](const std::array<int, 3>& high) {
                if (!all(low, high) || !is_largest(low, high)) return;
                const Vec3 a = p.corner(low[0], low[1], low[2]), b = p.corner(high[0], high[1], high[2]);
                out.push_back({Box(0.5 * (b - a)), 0.5 * (a + b)});
              });
  });
  return out;
}

}  // namespace epafi::support
