#include "viz_export/view/refine.h"

#include <array>
#include <utility>

namespace epafi {
namespace {

using V3 = Eigen::Vector3f;
using Ends = std::pair<std::uint32_t, std::uint32_t>;  // points, the lower first

/// An edge as part of one triangle: the normals at its ends.
using Side = std::array<V3, 2>;

constexpr float smooth = 0.97f;  // cosine: normals of both sides that are nearer than 14 degrees are one

/// Projection of the edge `way` on the tangent plane at its end, or on the crease where the sides differ in normals;
/// the whole edge at a border.
V3 along_surface(const V3& way, const std::vector<Side>& sides, std::size_t end) {
  if (sides.size() != 2) return way;
  const V3 one = sides[0][end], two = sides[1][end];
  if (one.dot(two) > smooth) {
    const V3 normal = (one + two).normalized();
    return way - way.dot(normal) * normal;
  }
  const V3 crease = one.cross(two).normalized();
  return way.dot(crease) * crease;
}

/// Tangent of length |way| 2 / (1 + c), c the cosine between tangent and chord: makes the middle of a circular arc
/// exact.
V3 tangent(const V3& way, const std::vector<Side>& sides, std::size_t end) {
  const V3 part = along_surface(way, sides, end);
  const float whole = way.norm(), length = part.norm();
  if (!(length > 0)) return way;
  return part * (whole / length * 2 / (1 + length / whole));
}

/// Middle of the cubic curve with these ends and tangents.
V3 middle(const V3& from, const V3& to, const std::vector<Side>& sides) {
  const V3 way = to - from;
  const V3 first = from + tangent(way, sides, 0) / 3, second = to - tangent(way, sides, 1) / 3;
  return (from + 3 * first + 3 * second + to) / 8;
}

class Refiner {
 public:
  explicit Refiner(const ViewMesh& mesh) : mesh_(mesh), out_{mesh.points, {}, {}} {
    for (std::size_t c = 0; c < mesh.corners.size(); c += 3)
      for (std::size_t k = 0; k < 3; ++k) add_side(c + k, c + (k + 1) % 3);
    for (const auto& [ends, sides] : sides_) {
      middles_[ends] = static_cast<std::uint32_t>(out_.points.size());
      out_.points.push_back(middle(mesh.points[ends.first], mesh.points[ends.second], sides));
    }
  }

  ViewMesh take() {
    for (std::size_t c = 0; c < mesh_.corners.size(); c += 3) {
      for (std::size_t k = 0; k < 3; ++k) {
        add_corner(c + k);
        add_middle(c + k, c + (k + 1) % 3);
        add_middle(c + (k + 2) % 3, c + k);
      }
      for (std::size_t k = 0; k < 3; ++k) add_middle(c + k, c + (k + 1) % 3);
    }
    return std::move(out_);
  }

 private:
  Ends ends(std::size_t from, std::size_t to) const { return std::minmax(mesh_.corners[from], mesh_.corners[to]); }

  void add_side(std::size_t from, std::size_t to) {
    if (mesh_.corners[from] > mesh_.corners[to]) std::swap(from, to);
    sides_[ends(from, to)].push_back({mesh_.normals[from], mesh_.normals[to]});
  }
  void add_corner(std::size_t corner) {
    out_.corners.push_back(mesh_.corners[corner]);
    out_.normals.push_back(mesh_.normals[corner]);
  }
  void add_middle(std::size_t from, std::size_t to) {
    out_.corners.push_back(middles_.at(ends(from, to)));
    out_.normals.push_back((mesh_.normals[from] + mesh_.normals[to]).normalized());
  }

  const ViewMesh& mesh_;
  ViewMesh out_;
  std::map<Ends, std::vector<Side>> sides_;
  std::map<Ends, std::uint32_t> middles_;
};

}  // namespace

ViewMesh refined(const ViewMesh& mesh) { return Refiner(mesh).take(); }

}  // namespace epafi
