#include "detection/surfaces/surface_gap.h"

#include <cmath>

namespace epafi {
namespace {

Vec3 area_vector(std::span<const Vec3> x, const Triangle& t) {
  return 0.5 * (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
}

double angle_at(std::span<const Vec3> x, const Triangle& t, std::size_t k) {
  const Vec3 p = x[t[(k + 1) % 3]] - x[t[k]], q = x[t[(k + 2) % 3]] - x[t[k]];
  return std::atan2(p.cross(q).norm(), p.dot(q));
}

/// Appends a candidate: the slave's nodes with their weights, the master's with the negative of theirs.
void append(GapRows& out, const ProjectionSurface::Projection& p, const Triangle& master,
            std::span<const std::uint32_t> slave, std::span<const double> weight) {
  out.gap.push_back(p.gap);
  out.normal.push_back(p.normal);
  for (std::size_t k = 0; k < slave.size(); ++k) {
    out.node.push_back(slave[k]);
    out.weight.push_back(weight[k]);
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (p.weight[k] != 0.0) {
      out.node.push_back(master[k]);
      out.weight.push_back(-p.weight[k]);
    }
  out.begin.push_back(static_cast<std::uint32_t>(out.node.size()));
}

}  // namespace

ProjectionSurface::ProjectionSurface(std::span<const Vec3> positions, std::span<const Triangle> triangles)
    : tree_(positions, triangles) {
  neighbour_.assign(triangles.size(), {NearestOnSurface::none, NearestOnSurface::none, NearestOnSurface::none});
  const auto uses = sorted_edge_uses(std::vector<Triangle>(triangles.begin(), triangles.end()));
  for (std::size_t k = 0; k + 1 < uses.size(); ++k) {
    if (uses[k].edge() != uses[k + 1].edge()) continue;
    neighbour_[uses[k].triangle][uses[k].side] = uses[k + 1].triangle;
    neighbour_[uses[k + 1].triangle][uses[k + 1].side] = uses[k].triangle;
  }
  update(positions);
}

void ProjectionSurface::update(std::span<const Vec3> positions) {
  tree_.refit(positions);
  const auto triangles = tree_.triangles();
  face_normal_.resize(triangles.size());
  node_normal_.assign(positions.size(), Vec3::Zero());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    face_normal_[t] = area_vector(positions, triangles[t]).normalized();
    for (std::size_t k = 0; k < 3; ++k)
      node_normal_[triangles[t][k]] += angle_at(positions, triangles[t], k) * face_normal_[t];
  }
}

ProjectionSurface::Projection ProjectionSurface::project(std::span<const Vec3> positions, const Vec3& x,
                                                         double band) const {
  Projection p;
  const NearestOnSurface nearest = tree_.nearest(positions, x, band);
  if (nearest.triangle == NearestOnSurface::none) return p;
  p.triangle = nearest.triangle;
  const Triangle& t = tree_.triangles()[p.triangle];
  const auto part = static_cast<std::uint32_t>(nearest.at.part);
  const Vec3 &face = face_normal_[p.triangle], apart = x - nearest.at.point;
  Vec3 outward = face;
  if (part >= 4) {
    p.weight[part - 4] = 1.0;
    outward = node_normal_[t[part - 4]];
  } else if (part >= 1) {
    const std::size_t k = part - 1, next = (k + 1) % 3;
    const Vec3 e = positions[t[next]] - positions[t[k]];
    p.weight[next] = (nearest.at.point - positions[t[k]]).dot(e) / e.squaredNorm();
    p.weight[k] = 1.0 - p.weight[next];
    const std::uint32_t other = neighbour_[p.triangle][k];
    if (other != NearestOnSurface::none) outward += face_normal_[other];
  } else {
    const Vec3 whole = area_vector(positions, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &q = positions[t[(k + 1) % 3]], &r = positions[t[(k + 2) % 3]];
      p.weight[k] = 0.5 * (q - nearest.at.point).cross(r - nearest.at.point).dot(whole) / whole.squaredNorm();
    }
  }
  const double sign = apart.dot(outward) < 0.0 ? -1.0 : 1.0;
  p.gap = sign * nearest.at.distance;
  // On the surface itself, and over a face, the difference of the points says nothing that the face does not say
  // better.
  const bool beside = part >= 1 && nearest.at.distance > 1e-12 * (positions[t[1]] - positions[t[0]]).norm();
  p.normal = beside ? Vec3(sign / nearest.at.distance * apart) : part == 0 ? face : Vec3(outward.normalized());
  return p;
}

NodeToSurface::NodeToSurface(std::span<const Vec3> positions, std::span<const Triangle> master,
                             std::span<const Triangle> slave, double band)
    : master_(positions, master), slave_(slave.begin(), slave.end()), band_(band) {
  for (const Triangle& t : slave_) nodes_.insert(nodes_.end(), t.begin(), t.end());
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
}

void NodeToSurface::evaluate(std::span<const Vec3> positions, GapRows& out, std::vector<GapSite>* sites) const {
  out.clear();
  master_.update(positions);
  std::vector<double> area(positions.size(), 0.0);
  for (const Triangle& t : slave_)
    for (const std::uint32_t v : t) area[v] += area_vector(positions, t).norm() / 3.0;
  if (sites) sites->clear();
  for (const std::uint32_t node : nodes_) {
    const auto p = master_.project(positions, positions[node], band_);
    if (p.triangle == NearestOnSurface::none) continue;
    const double one = 1.0;
    append(out, p, master_.triangles()[p.triangle], {&node, 1}, {&one, 1});
    out.area.push_back(area[node]);
    if (sites) sites->push_back({node, p.triangle, area[node]});
  }
}

SurfaceToSurface::SurfaceToSurface(std::span<const Vec3> positions, std::span<const Triangle> master,
                                   std::span<const Triangle> slave, double band)
    : master_(positions, master), slave_(slave.begin(), slave.end()), band_(band) {}

void SurfaceToSurface::evaluate(std::span<const Vec3> positions, GapRows& out, std::vector<GapSite>* sites) const {
  out.clear();
  master_.update(positions);
  if (sites) sites->clear();
  for (std::uint32_t t = 0; t < slave_.size(); ++t) {
    const Triangle& slave = slave_[t];
    const double third = area_vector(positions, slave).norm() / 3.0;
    for (std::size_t q = 0; q < 3; ++q) {
      std::array<double, 3> weight{1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0};
      weight[q] = 2.0 / 3.0;
      const Vec3 x =
          weight[0] * positions[slave[0]] + weight[1] * positions[slave[1]] + weight[2] * positions[slave[2]];
      const auto p = master_.project(positions, x, band_);
      if (p.triangle == NearestOnSurface::none) continue;
      append(out, p, master_.triangles()[p.triangle], slave, weight);
      out.area.push_back(third);
      if (sites) sites->push_back({t, p.triangle, third});
    }
  }
}

std::unique_ptr<GapOperator> make_gap_operator(GapMethod method, std::span<const Vec3> nodes,
                                               std::span<const Triangle> first, std::span<const Triangle> second,
                                               double band) {
  if (method == GapMethod::node_to_surface) return std::make_unique<NodeToSurface>(nodes, first, second, band);
  return std::make_unique<SurfaceToSurface>(nodes, first, second, band);
}

}  // namespace epafi
