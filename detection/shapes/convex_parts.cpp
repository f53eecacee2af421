#include "detection/shapes/convex_parts.h"

#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "detection/aabb.h"
#include "detection/mass_properties.h"
#include "detection/narrow/polyhedra/clipped_solid.h"
#include "detection/shapes/surface_crossing.h"

namespace epafi {
namespace {

constexpr double same_volume = 1e-9;      // relative: two parts whose hull has their volume are one convex part
constexpr double rounding = 1e-12;        // of the size: what cuts are exact to
constexpr std::size_t most_cells = 4096;  // before joining: far beyond the parts that a body can carry
constexpr std::size_t most_cuts = 1 << 16, most_depth = 2000;  // of the tree; a level takes about 1 kB of the stack
constexpr std::size_t most_choices = 64;                       // cuts that are compared, of the largest faces

/// What of a triangle lies in a cell: convex, in the plane of its face.
struct Fragment {
  std::vector<Vec3> corners;
  std::uint32_t face;
};

enum class Side { on, below, above, both };

double area_of(const Fragment& f) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < f.corners.size(); ++k)
    sum += (f.corners[k - 1] - f.corners[0]).cross(f.corners[k] - f.corners[0]);
  return 0.5 * sum.norm();
}

/// The planes of the faces, by the number of their lowest triangle.
std::vector<Plane> face_planes(const JoinedSurface& joined) {
  const TriangleSurface& s = joined.surface;
  std::vector<Vec3> area(s.triangles.size(), Vec3::Zero()), moment(s.triangles.size(), Vec3::Zero());
  std::vector<double> size(s.triangles.size(), 0.0);
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const auto& [i, j, k] = s.triangles[t];
    const Vec3 &a = s.vertices[i], &b = s.vertices[j], &c = s.vertices[k];
    const Vec3 twice = (b - a).cross(c - a);
    area[joined.face[t]] += twice;
    moment[joined.face[t]] += twice.norm() * (a + b + c) / 3.0;
    size[joined.face[t]] += twice.norm();
  }
  std::vector<Plane> planes(s.triangles.size());
  for (std::size_t f = 0; f < planes.size(); ++f) {
    if (!(size[f] > 0.0)) continue;
    const Vec3 n = area[f].normalized();
    planes[f] = {n, n.dot(moment[f] / size[f])};
  }
  return planes;
}

/// Whether a point is inside a closed surface: by the solid angle of its triangles (van Oosterom and Strackee 1983).
bool is_inside(const TriangleSurface& s, const Vec3& x) {
  double angle = 0.0;
  for (const Triangle& t : s.triangles) {
    const Vec3 a = s.vertices[t[0]] - x, b = s.vertices[t[1]] - x, c = s.vertices[t[2]] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle > 2.0 * std::numbers::pi;
}

/// Cuts the space around a surface to cells that are either all inside, or inside behind all faces in them.
class CellCutter {
 public:
  CellCutter(const JoinedSurface& joined, double tolerance)
      : surface_(joined.surface), planes_(face_planes(joined)), tolerance_(tolerance) {
    Aabb box;
    std::vector<Fragment> all;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      Fragment f{{}, joined.face[t]};
      for (const std::uint32_t v : surface_.triangles[t]) f.corners.push_back(surface_.vertices[v]);
      for (const Vec3& v : f.corners) box.include(v);
      all.push_back(std::move(f));
    }
    const Vec3 c = box.centre();
    const double r = 2.0 * box.extent().norm();  // a tetrahedron around the ball around the box
    ClippedSolid whole;
    whole.assign_tetrahedron(
        {c + r * Vec3(1, 1, 1), c + r * Vec3(1, -1, -1), c + r * Vec3(-1, 1, -1), c + r * Vec3(-1, -1, 1)});
    cut(whole, std::move(all));
  }

  std::vector<std::vector<Vec3>> cells;  ///< corners of each
  bool is_complete = true;               ///< false: there were too many

 private:
  /// A face in a cell, with the area that it has there.
  struct FaceHere {
    std::uint32_t face;
    double area;
  };

  Side side_of(const Fragment& f, const Plane& plane) const {
    bool above = false, below = false;
    for (const Vec3& x : f.corners) {
      const double h = plane.above(x);
      above = above || h > tolerance_;
      below = below || h < -tolerance_;
    }
    return above ? below ? Side::both : Side::above : below ? Side::below : Side::on;
  }

  static std::vector<FaceHere> faces_in(const std::vector<Fragment>& fragments) {
    std::vector<FaceHere> faces;
    for (const Fragment& f : fragments) faces.push_back({f.face, area_of(f)});
    std::sort(faces.begin(), faces.end(), [](const FaceHere& a, const FaceHere& b) { return a.face < b.face; });
    std::size_t kept = 0;
    for (const FaceHere& f : faces)
      if (kept > 0 && faces[kept - 1].face == f.face)
        faces[kept - 1].area += f.area;
      else
        faces[kept++] = f;
    faces.resize(kept);
    return faces;
  }

  /// The face whose plane has others in front and splits the fewest; nothing where all lie behind each other.
  std::optional<std::uint32_t> chosen_cut(const std::vector<Fragment>& fragments, std::vector<FaceHere> faces) const {
    const double nearly = 1e-6 * faces.front().area;  // equal faces in the order of the file, whatever rounding does
    std::stable_sort(faces.begin(), faces.end(), [&](const FaceHere& a, const FaceHere& b) {
      return std::floor(a.area / nearly) > std::floor(b.area / nearly);
    });
    std::optional<std::uint32_t> best;
    std::size_t fewest = SIZE_MAX, tried = 0;
    std::vector<std::uint32_t> split;
    for (const FaceHere& here : faces) {
      if (tried == most_choices) break;
      const Plane& plane = planes_[here.face];
      bool cuts = false;
      split.clear();
      for (const Fragment& f : fragments) {
        if (f.face == here.face) continue;
        const Side side = side_of(f, plane);
        cuts = cuts || side == Side::above || side == Side::both;
        if (side == Side::both) split.push_back(f.face);
      }
      if (!cuts) continue;
      ++tried;
      std::sort(split.begin(), split.end());
      const auto count = static_cast<std::size_t>(std::unique(split.begin(), split.end()) - split.begin());
      if (count >= fewest) continue;
      fewest = count;
      best = here.face;
    }
    return best;
  }

  /// Parts of the fragments on one side of a plane; what lies on it bounds both cells and is done.
  std::vector<Fragment> behind(const std::vector<Fragment>& fragments, const Plane& plane) const {
    std::vector<Fragment> out;
    for (const Fragment& f : fragments) {
      const Side side = side_of(f, plane);
      if (side == Side::below) out.push_back(f);
      if (side != Side::both) continue;
      Fragment& part = out.emplace_back(Fragment{{}, f.face});
      for (std::size_t k = 0; k < f.corners.size(); ++k) {
        const Vec3 &x = f.corners[k], &y = f.corners[(k + 1) % f.corners.size()];
        const double hx = plane.above(x), hy = plane.above(y);
        if (hx <= tolerance_) part.corners.push_back(x);
        const bool crosses = (hx > tolerance_ && hy < -tolerance_) || (hx < -tolerance_ && hy > tolerance_);
        if (crosses) part.corners.push_back(x + hx / (hx - hy) * (y - x));
      }
    }
    return out;
  }

  void keep(const ClippedSolid& cell) {
    auto& corners = cells.emplace_back();
    for (std::size_t k = 0; k < cell.points(); ++k) corners.push_back(cell.point(k));
    is_complete = is_complete && cells.size() <= most_cells;
  }

  void cut(ClippedSolid& cell, std::vector<Fragment> fragments, std::size_t depth = 0) {
    if (!is_complete) return;
    if (fragments.empty()) {
      const Volume volume = cell.volume();
      if (volume.volume > 0.0 && is_inside(surface_, volume.centroid())) keep(cell);
      return;
    }
    const auto faces = faces_in(fragments);
    const auto face = chosen_cut(fragments, faces);
    if (!face) {
      for (const FaceHere& f : faces)
        if (!cell.clip(planes_[f.face])) return;
      return keep(cell);
    }
    const Plane plane = planes_[*face], back{-plane.normal, -plane.offset};
    is_complete = ++cuts_ <= most_cuts && depth < most_depth;
    // the face bounds both cells, however far its corners lie off its plane: so each cut leaves one face less
    std::erase_if(fragments, [&](const Fragment& f) { return f.face == *face; });
    ClippedSolid front = cell;
    std::vector<Fragment> beyond = behind(fragments, back);
    fragments = behind(fragments, plane);
    if (cell.clip(plane)) cut(cell, std::move(fragments), depth + 1);
    if (front.clip(back)) cut(front, std::move(beyond), depth + 1);
  }

  const TriangleSurface& surface_;
  std::vector<Plane> planes_;
  double tolerance_;
  std::size_t cuts_ = 0;
};

/// How far corners lie off the planes of their faces.
double unevenness(const JoinedSurface& joined) {
  const TriangleSurface& s = joined.surface;
  const std::vector<Plane> planes = face_planes(joined);
  double off = 0.0;
  for (std::size_t t = 0; t < s.triangles.size(); ++t)
    for (const std::uint32_t v : s.triangles[t])
      off = std::max(off, std::abs(planes[joined.face[t]].above(s.vertices[v])));
  return off;
}

/// Nothing where the points enclose no volume worth a body (`least` [m^3]).
std::optional<ConvexPart> hull_of(std::span<const Vec3> points, double precision, double least) {
  try {
    ConvexPart part{hull_from_points(points, {}, precision)};
    const MassProperties whole = surface_mass_properties(part.surface.vertices, triangles_of(part.surface));
    part.volume = whole.mass;
    part.centre = whole.centre;
    if (part.volume > least) return part;
  } catch (const SceneError&) {
  }  // flat: thinner than rounding
  return std::nullopt;
}

/// Whether the whole of b lies behind each face of a, or beyond it: a union that is convex needs that, and one beyond.
bool may_join(const ConvexPart& a, const ConvexPart& b, double tolerance) {
  bool beyond = false;
  for (const auto& face : a.surface.faces) {
    const Vec3& p = a.surface.vertices[face[0]];
    Vec3 area = Vec3::Zero();
    for (std::size_t k = 2; k < face.size(); ++k)
      area += (a.surface.vertices[face[k - 1]] - p).cross(a.surface.vertices[face[k]] - p);
    const double slack = 4.0 * tolerance * area.norm();
    double low = infinity, high = -infinity;
    for (const Vec3& x : b.surface.vertices) {
      low = std::min(low, area.dot(x - p));
      high = std::max(high, area.dot(x - p));
    }
    if (high > slack && low < -slack) return false;
    beyond = beyond || high > slack;
  }
  return beyond;
}

Aabb box_of(const ConvexPart& part) {
  Aabb box;
  for (const Vec3& v : part.surface.vertices) box.include(v);
  return box;
}

/// Joins pairs whose hull has no more volume than they have, until there are none. tolerance: of corners to planes [m].
void join(std::vector<ConvexPart>& parts, double tolerance) {
  std::vector<Aabb> boxes;
  for (const ConvexPart& part : parts) boxes.push_back(box_of(part).fattened(4.0 * tolerance));
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t j = 0; j < parts.size(); ++j) {
      if (i == j || !boxes[i].overlaps(boxes[j])) continue;
      if (!may_join(parts[i], parts[j], tolerance) || !may_join(parts[j], parts[i], tolerance)) continue;
      auto points = parts[i].surface.vertices;
      points.insert(points.end(), parts[j].surface.vertices.begin(), parts[j].surface.vertices.end());
      auto both = hull_of(points, 0.25 * tolerance, 0.0);
      const double sum = parts[i].volume + parts[j].volume;
      Aabb box;
      for (const Vec3& v : points) box.include(v);
      if (!both || both->volume > sum * (1 + same_volume) + tolerance * box.extent().squaredNorm()) continue;
      parts[i] = std::move(*both);
      boxes[i] = box_of(parts[i]).fattened(4.0 * tolerance);
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(j));
      boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(j));
      if (j < i) --i;
      j = std::size_t(-1);  // what grew may join what it could not before
    }
}

constexpr const char* ways_out = "mend it in a mesh editor, or write polyhedron = { file = ... } for its convex hull";

/// Refuses a surface that goes through itself. slack: as in find_crossings().
void refuse_crossings(const TriangleSurface& surface, double slack, const Place& place) {
  const SurfaceCrossings c = find_crossings(surface, slack);
  if (c.triangles == 0) return;
  throw SceneError(fmt::format("the surface crosses itself: {} of its {} triangles go through others, the first at "
                               "({:.6g}, {:.6g}, {:.6g}) m; {}",
                               c.triangles, surface.triangles.size(), c.first.x(), c.first.y(), c.first.z(), ways_out),
                   place);
}

}  // namespace

std::vector<ConvexPart> convex_parts(const JoinedSurface& joined, double precision, const Place& place) {
  const double volume = surface_mass_properties(joined.surface).mass;
  Aabb box;
  for (const Vec3& v : joined.surface.vertices) box.include(v);
  const double size = box.extent().norm(), off = std::max(unevenness(joined), 4.0 * joined.report.move_distance);
  const double tolerance = std::max({4.0 * precision, rounding * size, std::min(off, joined.report.tolerance)});
  refuse_crossings(joined.surface, joined.report.tolerance, place);
  const CellCutter cutter(joined, tolerance);
  if (!cutter.is_complete)
    throw SceneError(fmt::format("the surface takes more than {} cuts to convex parts; simplify it, or write "
                                 "polyhedron = {{ file = ... }} for its convex hull",
                                 most_cells),
                     place);
  std::vector<ConvexPart> parts;
  double sum = 0;
  for (const auto& c : cutter.cells)
    if (auto part = hull_of(c, 0.25 * tolerance, 1e-12 * volume)) {
      sum += part->volume;
      parts.push_back(std::move(*part));
    }
  if (!(std::abs(sum - volume) <= same_volume * volume + tolerance * size * size)) {
    refuse_crossings(joined.surface, -tolerance, place);
    throw SceneError(fmt::format("the surface cannot be cut into convex parts: they hold {:.6g} of {:.6g} m^3. It "
                                 "touches itself or encloses a part twice; {}",
                                 sum, volume, ways_out),
                     place);
  }
  join(parts, tolerance);
  return parts;
}

}  // namespace epafi
