#include "detection/shapes/convex_hull.h"

#include <fmt/format.h>
#include <numbers>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "detection/shapes/rounded_shapes.h"
#include "engine/lanes/prefetch.h"

namespace epafi {
namespace {

using Faces = std::vector<std::vector<std::uint32_t>>;
using DirectedEdges = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>;  // (from, to) -> face

constexpr double merge_tolerance = 1e-13;   // of the radius: some 500 ulp, above the rounding of computed hulls
constexpr double convex_tolerance = 1e-12;  // of the radius: what later shows as an error of a depth

/// Twice the vector area, taken about the polygon's first vertex so that distance from the origin costs no digits.
Vec3 area_vector(const std::vector<Vec3>& vertices, const std::vector<std::uint32_t>& face) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < face.size(); ++k) {
    sum += (vertices[face[k]] - vertices[face[0]]).cross(vertices[face[k + 1]] - vertices[face[0]]);
  }
  return sum;
}

std::string check_input(const std::vector<Vec3>& vertices, const Faces& faces) {
  if (vertices.size() < 4 || faces.size() < 4) return "a polyhedron needs at least 4 vertices and 4 faces";
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!vertices[i].allFinite()) return fmt::format("vertex {} is not finite", i);
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (faces[f].size() < 3) return fmt::format("face {} has {} vertices, at least 3 are needed", f, faces[f].size());
    for (std::uint32_t v : faces[f]) {
      if (v >= vertices.size()) return fmt::format("face {} names vertex {}, there are {}", f, v, vertices.size());
    }
    const Vec3 area = area_vector(vertices, faces[f]);
    if (!(area.squaredNorm() > 0.0)) return fmt::format("face {} has no area", f);
  }
  return {};
}

/// Every directed edge once, its opposite once.
std::string collect_edges(const Faces& faces, DirectedEdges& edges) {
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 0; k < faces[f].size(); ++k) {
      const std::pair edge(faces[f][k], faces[f][(k + 1) % faces[f].size()]);
      if (!edges.emplace(edge, f).second) {
        return fmt::format("edge {}-{} is used twice in the same direction (faces {} and {})", edge.first, edge.second,
                           edges[edge], f);
      }
    }
  }
  for (const auto& [edge, face] : edges) {
    if (!edges.count({edge.second, edge.first})) {
      return fmt::format("the surface is open at edge {}-{} of face {}", edge.first, edge.second, face);
    }
  }
  return {};
}

/// Joins neighbours that lie in one plane; returns their outlines.
std::string merge_coplanar(const std::vector<Vec3>& vertices, Faces& faces, const DirectedEdges& edges, double radius) {
  std::vector<std::uint32_t> group(faces.size());
  std::iota(group.begin(), group.end(), 0u);
  const auto find = [&](std::uint32_t f) {
    while (group[f] != f) f = group[f] = group[group[f]];
    return f;
  };
  std::vector<Vec3> normals;
  for (const auto& face : faces) normals.push_back(area_vector(vertices, face).normalized());
  const auto lies_in = [&](std::uint32_t f, std::uint32_t g) {  // face f in the plane of g
    return std::all_of(faces[f].begin(), faces[f].end(), [&](std::uint32_t v) {
      return std::abs(normals[g].dot(vertices[v] - vertices[faces[g][0]])) <= merge_tolerance * radius;
    });
  };
  for (const auto& [edge, f] : edges) {
    const std::uint32_t g = edges.at({edge.second, edge.first});
    if (f < g && normals[f].dot(normals[g]) > 0.0 && lies_in(f, g) && lies_in(g, f)) group[find(f)] = find(g);
  }
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> outline;  // group -> next vertex along its border
  for (const auto& [edge, f] : edges) {
    if (find(f) == find(edges.at({edge.second, edge.first}))) continue;
    if (!outline[find(f)].emplace(edge.first, edge.second).second)
      return fmt::format("the surface meets itself at vertex {}", edge.first);
  }
  faces.clear();
  for (const auto& [name, next] : outline) {
    std::vector<std::uint32_t> loop{next.begin()->first};
    while (next.at(loop.back()) != loop.front() && loop.size() <= next.size()) loop.push_back(next.at(loop.back()));
    if (loop.size() != next.size()) return fmt::format("the face at vertex {} has a hole", loop.front());
    faces.push_back(std::move(loop));
  }
  return {};
}

/// Drops vertices that no face uses any more.
void compact(std::vector<Vec3>& vertices, Faces& faces) {
  constexpr std::uint32_t unused = 0xffffffffu;
  std::vector<std::uint32_t> name(vertices.size(), unused);
  for (const auto& face : faces) {
    for (std::uint32_t v : face) name[v] = 0;
  }
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (name[v] == unused) continue;
    vertices[count] = vertices[v];
    name[v] = count++;
  }
  vertices.resize(count);
  for (auto& face : faces) {
    for (std::uint32_t& v : face) v = name[v];
  }
}

std::string find_planes(ConvexHull& hull, const Faces& faces, double tolerance) {
  hull.inner_radius = infinity;
  for (const auto& face : faces) {
    const Vec3 n = area_vector(hull.vertices, face).normalized();
    double own = -infinity, all = -infinity;
    for (std::uint32_t v : face) own = std::max(own, n.dot(hull.vertices[v]));
    std::size_t worst = 0;
    for (std::size_t v = 0; v < hull.vertices.size(); ++v) {
      if (n.dot(hull.vertices[v]) > all) {
        all = n.dot(hull.vertices[v]);
        worst = v;
      }
    }
    if (all > own + convex_tolerance * hull.radius + tolerance) {
      return fmt::format("not convex: vertex {} lies {:.3g} outside a face", worst, all - own);
    }
    hull.face_normals.push_back(n);
    hull.face_offsets.push_back(all);  // the supporting plane: no vertex is above it
    hull.inner_radius = std::min(hull.inner_radius, all);
  }
  if (!(hull.inner_radius > 0.0)) return "the origin is not inside";
  return {};
}

/// CSR lists from rows.
void flatten(const Faces& rows, std::vector<std::uint32_t>& begin, std::vector<std::uint32_t>& values) {
  begin.assign(1, 0u);
  values.clear();
  for (const auto& row : rows) {
    values.insert(values.end(), row.begin(), row.end());
    begin.push_back(static_cast<std::uint32_t>(values.size()));
  }
}

void find_topology(ConvexHull& hull, const Faces& faces, const DirectedEdges& edges) {
  flatten(faces, hull.face_begin, hull.face_vertices);
  Faces neighbours(hull.vertices.size()), fans(hull.vertices.size());
  const auto before = [&](std::uint32_t vertex, std::uint32_t face) {
    const auto& loop = faces[face];
    const auto at = std::ranges::find(loop, vertex);
    return at == loop.begin() ? loop.back() : *(at - 1);
  };
  for (const auto& [edge, first] : edges) {
    const auto [from, to] = edge;
    if (from < to) hull.edges.push_back({from, to, first, edges.at({to, from})});
    if (!fans[from].empty()) continue;
    std::uint32_t next = to, face = first;
    do {
      neighbours[from].push_back(next);
      fans[from].push_back(face);
      next = before(from, face);
      face = edges.at({from, next});
    } while (next != to);
  }
  flatten(neighbours, hull.neighbour_begin, hull.neighbours);
  flatten(fans, hull.fan_begin, hull.fans);
}

/// Volume and second moments by tetrahedra from the origin (Tonon 2004; all signs positive, so no digits are lost).
void find_mass(ConvexHull& hull, const Faces& faces) {
  Mat3 second = Mat3::Zero();  // integral of x x^T
  hull.volume = 0.0;
  for (const auto& face : faces) {
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      const Vec3 &a = hull.vertices[face[0]], &b = hull.vertices[face[k]], &c = hull.vertices[face[k + 1]];
      const double v = a.dot(b.cross(c)) / 6.0;
      const Vec3 s = a + b + c;
      second += v / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
      hull.volume += v;
    }
  }
  hull.inertia = second.trace() * Mat3::Identity() - second;
  hull.equal_volume_radius = std::cbrt(0.75 * hull.volume / std::numbers::pi);
}

HullLanes lanes_of(const PolyhedronView& p) {
  HullLanes out;
  for (std::size_t k = 0; k < p.vertices.size(); k += lane_count) out.vertices.push_back(vertex_lanes(p.vertices, k));
  for (std::size_t k = 0; k < p.face_normals.size(); k += lane_count)
    out.faces.push_back(face_lanes(p.face_normals, p.face_offsets, k));
  for (std::size_t k = 0; k < p.edges.size(); k += lane_count)
    out.edges.push_back(edge_lanes(p.edges, p.face_normals, k));
  return out;
}

constexpr std::size_t direction_cells = 8;  // along each side of the cube of directions
constexpr std::size_t large_hull =
    96;  // vertices: up to here a scan is as quick (perf_hull: 64 by scan 40 ns, climbing 92)

std::size_t cell_of(const Vec3& d) {
  int axis = 0;
  const double longest = d.cwiseAbs().maxCoeff(&axis);
  if (!(longest > 0.0)) return 0;
  const auto place = [&](int k) {
    return std::min(direction_cells - 1, static_cast<std::size_t>((d[k] / longest + 1.0) * (0.5 * direction_cells)));
  };
  const std::size_t side = 2 * static_cast<std::size_t>(axis) + (d[axis] > 0.0 ? 1 : 0);
  return (side * direction_cells + place((axis + 1) % 3)) * direction_cells + place((axis + 2) % 3);
}

void find_starts(ConvexHull& hull) {
  if (hull.vertices.size() <= large_hull) return;
  constexpr double cell = 2.0 / direction_cells;
  std::uint32_t near = 0;
  for (int side = 0; side < 6; ++side) {
    for (std::size_t i = 0; i < direction_cells; ++i) {
      for (std::size_t j = 0; j < direction_cells; ++j) {
        Vec3 d;
        const int axis = side / 2;
        d[axis] = side % 2 ? 1.0 : -1.0;
        d[(axis + 1) % 3] = (static_cast<double>(i) + 0.5) * cell - 1.0;
        d[(axis + 2) % 3] = (static_cast<double>(j) + 0.5) * cell - 1.0;
        hull.starts.push_back(near = ConvexHull::climb(hull.view(), d, near));
      }
    }
  }
}

/// The frame of a rectangular box: three pairs of opposite faces across each other.
std::optional<BoxFrame> find_box(const ConvexHull& hull) {
  if (hull.vertices.size() != 8 || hull.face_normals.size() != 6 || hull.edges.size() != 12) return {};
  constexpr double square = 1e-9;  // only the choice of a starting axis depends on it
  BoxFrame frame;
  std::array<std::size_t, 6> axis_of{};
  std::array<bool, 6> taken{};
  std::size_t axes = 0;
  for (std::uint32_t f = 0; f < 6; ++f) {
    if (taken[f]) continue;
    std::uint32_t g = f + 1;
    while (g < 6 && (hull.face_normals[f] + hull.face_normals[g]).norm() > square) ++g;
    if (g == 6 || axes == 3) return {};
    frame.skew = std::max(frame.skew, (hull.face_normals[f] + hull.face_normals[g]).norm());
    taken[f] = taken[g] = true;
    axis_of[f] = axis_of[g] = axes;
    frame.face[axes] = {g, f};
    const double high = hull.face_offsets[f], low = hull.face_offsets[g];
    frame.half[static_cast<int>(axes)] = 0.5 * (high + low);
    frame.centre += 0.5 * (high - low) * hull.face_normals[f];
    ++axes;
  }
  for (std::size_t i = 0; i < 3; ++i)
    frame.skew = std::max(
        frame.skew, std::abs(hull.face_normals[frame.face[i][1]].dot(hull.face_normals[frame.face[(i + 1) % 3][1]])));
  if (frame.skew > square) return {};
  for (std::uint32_t e = 0; e < 12; ++e) {
    const std::uint32_t l = hull.edges[e].left, r = hull.edges[e].right;
    const std::size_t i = 3 - axis_of[l] - axis_of[r];
    const bool left_first = axis_of[l] == (i + 1) % 3;
    const std::uint32_t first = left_first ? l : r, second = left_first ? r : l;
    const bool high1 = frame.face[(i + 1) % 3][1] == first, high2 = frame.face[(i + 2) % 3][1] == second;
    frame.edge[i][2u * high1 + high2] = e;
  }
  return frame;
}

}  // namespace

ConvexHull::Built ConvexHull::from_faces(std::vector<Vec3> points,
                                         const std::vector<std::vector<std::uint32_t>>& polygons) {
  return built_hull({std::move(points), polygons});
}

ConvexHull::Built built_hull(HullSurface surface) {
  auto& [points, faces, tolerance] = surface;
  ConvexHull::Built built;
  ConvexHull& hull = built.hull;
  const auto failed = [&](std::string problem) { return !(built.problem = std::move(problem)).empty(); };
  if (failed(check_input(points, faces))) return built;
  DirectedEdges edges;
  if (failed(collect_edges(faces, edges))) return built;
  double radius = 0.0;
  for (const Vec3& v : points) radius = std::max(radius, v.norm());
  if (failed(merge_coplanar(points, faces, edges, radius))) return built;
  compact(points, faces);
  edges.clear();
  if (failed(collect_edges(faces, edges))) return built;

  hull.vertices = std::move(points);
  for (const Vec3& v : hull.vertices) hull.radius = std::max(hull.radius, v.norm());
  if (failed(find_planes(hull, faces, tolerance))) return built;
  find_topology(hull, faces, edges);
  const std::size_t euler = hull.vertices.size() + faces.size() - hull.edges.size();  // V - E + F = 2
  if (euler != 2) {
    built.problem = fmt::format("the surface is not one closed sphere: vertices - edges + faces = {}, not 2",
                                static_cast<long>(euler));
    return built;
  }
  find_mass(hull, faces);
  hull.box_frame = find_box(hull);
  hull.lanes = lanes_of(hull.view());
  find_starts(hull);
  return built;
}

void ConvexHull::prefetch() const {
  constexpr std::size_t small_hull = 40;  // vertices: these columns of more would fill over a fifth of the first cache
  if (vertices.size() > small_hull) return;
  const auto all = [](const auto& column) { epafi::prefetch(column.data(), column.size() * sizeof(column[0])); };
  all(lanes.faces);
  all(lanes.vertices);
  all(vertices);
  all(face_normals);
}

PolyhedronView ConvexHull::view() const {
  return {vertices,
          face_begin,
          face_vertices,
          face_normals,
          face_offsets,
          edges,
          neighbour_begin,
          neighbours,
          fan_begin,
          fans,
          radius,
          inner_radius,
          box_frame ? &*box_frame : nullptr,
          starts,
          lanes.vertices,
          lanes.faces,
          lanes.edges};
}

Vec3 ConvexHull::support(const Vec3& d) const {
  // without a view in the loop of GJK
  return vertices[vertices.size() <= large_hull ? hull_kernels().farthest(lanes.vertices, d)
                                                : support_vertex(view(), d)];
}

std::uint32_t ConvexHull::support_vertex(const PolyhedronView& p, const Vec3& d, std::uint32_t start) {
  const auto n = static_cast<std::uint32_t>(p.vertices.size());
  if (n <= large_hull) return hull_kernels().farthest(p.vertex_lanes, d);
  return climb(p, d, start == 0 && !p.starts.empty() ? p.starts[cell_of(d)] : start);
}

std::uint32_t ConvexHull::climb(const PolyhedronView& p, const Vec3& d, std::uint32_t start) {
  std::uint32_t best = start;
  double height = d.dot(p.vertices[best]);
  for (bool climbed = true; climbed;) {
    climbed = false;
    for (std::uint32_t k = p.neighbour_begin[best], end = p.neighbour_begin[best + 1]; k < end; ++k) {
      const double h = d.dot(p.vertices[p.neighbours[k]]);
      if (h > height) {
        height = h;
        best = p.neighbours[k];
        climbed = true;
      }
    }
  }
  return best;
}

Aabb ConvexHull::bounding_box(const Pose& pose) const {
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  Aabb box;
  if (vertices.size() <= 24) {
    for (const Vec3& v : vertices) box.include(rotation * v);
  } else {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 d = rotation.row(axis).transpose();
      box.max[axis] = d.dot(support(d));
      box.min[axis] = d.dot(support(-d));
    }
  }
  return {pose.position + box.min - Vec3::Constant(sweep), pose.position + box.max + Vec3::Constant(sweep)};
}

Entry ConvexHull::entry() {
  return {name,
          "convex polyhedron: hull of points, optionally swept by a sphere",
          {{"vertices", "", "m", Kind::vectors, {}, any_number, "points whose hull is taken", true},
           {"file", "", "", Kind::text, {}, {}, "OBJ or STL file whose hull is taken", true},
           {"random", "", "", Kind::table, {}, {}, "random hull: { vertices =, seed = }", true}},
          {},
          ""};
}

}  // namespace epafi
