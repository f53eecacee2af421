#include "laws/nonsmooth/islands.h"

#include <algorithm>
#include <cmath>

namespace epafi {

namespace {
constexpr std::uint32_t no_body = ConeProblem::no_body;
}

std::uint32_t Islands::root(std::uint32_t i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void Islands::find(const ConeProblem& p) {
  const auto n = static_cast<std::uint32_t>(p.size());
  norm_ = p.q_norm();
  parent_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) parent_[i] = i;
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);  // the root is the first contact
  };
  if (p.has_bodies()) {
    first_.assign(p.bodies(), no_body);
    for (std::uint32_t i = 0; i < n; ++i)
      for (const std::uint32_t body : p.rows[i].body) {
        if (body == no_body) continue;
        if (first_[body] == no_body)
          first_[body] = i;
        else
          join(i, first_[body]);
      }
  } else {
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::size_t k = p.begin[i]; k < p.begin[i + 1]; ++k) join(i, p.column[k]);
  }
  island_.resize(n);
  order_.resize(n);
  place_.resize(n);
  body_place_.assign(p.bodies(), no_body);
  begin_.assign(1, 0);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t r = root(i);
    island_[i] = r == i ? static_cast<std::uint32_t>(begin_.size() - 1) : island_[r];
    if (r == i) begin_.push_back(0);
    place_[i] = static_cast<std::uint32_t>(begin_[island_[i] + 1]++);
  }
  for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
  for (std::uint32_t i = 0; i < n; ++i) order_[begin_[island_[i]] + place_[i]] = i;
  first_.assign(size(), 0);  // bodies counted so far in each island
  for (std::uint32_t i = 0; i < n && p.has_bodies(); ++i)
    for (const std::uint32_t body : p.rows[i].body)
      if (body != no_body && body_place_[body] == no_body) body_place_[body] = first_[island_[i]]++;
}

void Islands::extract(const ConeProblem& p, std::size_t k, ConeProblem& out) const {
  const auto chosen = contacts(k);
  const std::size_t n = chosen.size();
  out.friction.resize(n);
  out.q.resize(n);
  out.diagonal.resize(n);
  out.rows.resize(p.has_bodies() ? n : 0);
  out.mass.clear();
  out.begin.assign(1, 0);
  out.column.clear();
  out.block.clear();
  out.scale = p.scale;
  out.reference = norm_ * std::sqrt(static_cast<double>(n) / static_cast<double>(p.size()));
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t from = chosen[i];
    out.friction[i] = p.friction[from];
    out.q[i] = p.q[from];
    out.diagonal[i] = p.diagonal[from];
    if (!p.has_bodies()) {
      for (std::size_t b = p.begin[from]; b < p.begin[from + 1]; ++b) {
        out.column.push_back(place_[p.column[b]]);
        out.block.push_back(p.block[b]);
      }
      out.begin.push_back(out.column.size());
      continue;
    }
    out.rows[i] = p.rows[from];
    for (std::uint32_t& body : out.rows[i].body) {
      if (body == no_body) continue;
      const std::uint32_t place = body_place_[body];
      if (place >= out.mass.size()) out.mass.resize(place + 1);
      out.mass[place] = p.mass[body];
      body = place;
    }
  }
  // contacts between bodies that cannot move have no rows to solve; the problem stays in body form all the same
  if (p.has_bodies() && out.mass.empty()) out.mass.assign(1, Mat6::Identity());
}

}  // namespace epafi
