#include <algorithm>
#include <cmath>

#include "detection/narrow/mesh/mesh_pairs.h"
#include "detection/narrow/mesh/mesh_region.h"
#include "detection/narrow/pairs/flat_patch.h"
#include "detection/narrow/pairs/side_clip.h"

namespace epafi {
namespace {

constexpr double on_surface = 1e-6;  // of the size, as in the manifold: what counts as lying on an edge or triangle
constexpr double along_face = 1e-5;  // [rad]
constexpr double same_edge_cosine = 0.7;  // directions nearer than 45 degrees at one point of the surface are one
constexpr double narrow_enough = 1e-6;    // of the size: a wider interval than this is reported as degenerate

/// True if all triangles are inside one face, so that the body is on a plane. (If the face ended below the body, one of
/// them would have an open or bent side.) A box on 30 triangles then takes 0.2 us (perf/mesh.cpp).
bool all_plain(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
  return std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
    const auto& kinds = mesh.edge_kinds[t];
    return mesh.face[t] == mesh.face[triangles.front()] &&
           std::all_of(kinds.begin(), kinds.end(), [](EdgeKind k) { return k == EdgeKind::flat; });
  });
}

/// What the body turns along d (its axes): the corners of a face, of a flat end or of a straight side.
void side_along(const MeshGuest& body, const Vec3& d, std::vector<SidePoint>& out) {
  if (body.polyhedron) {
    const PolyhedronView& p = *body.polyhedron;
    const std::uint32_t face = face_along(p, d);
    for (std::uint32_t k = p.face_begin[face]; k < p.face_begin[face + 1]; ++k)
      out.push_back({p.vertices[p.face_vertices[k]], p.face_vertices[k], 0});
  } else if (body.facing) {
    const FlatSide side = leaning_side(body.shape, body.facing, d);
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(side.count); ++k) out.push_back({side.corner[k], k, 0});
  }
}

/// What of it may be deepest in a plane across d: of a polyhedron the corners of all faces that look along d, as those
/// of one alone would let go of one that is deep when the face turns; else its side and its tip.
void corners_along(const MeshGuest& body, const Vec3& d, std::vector<SidePoint>& out) {
  if (!body.polyhedron) {
    side_along(body, d, out);
    out.push_back({body.core.support(d), 0xffffu, 0});
    return;
  }
  const PolyhedronView& p = *body.polyhedron;
  for (std::uint32_t v = 0; v < p.vertices.size(); ++v) {
    const auto fans = p.fans.subspan(p.fan_begin[v], p.fan_begin[v + 1] - p.fan_begin[v]);
    const auto looks = [&](std::uint32_t face) { return p.face_normals[face].dot(d) > facing_cosine; };
    if (std::ranges::any_of(fans, looks)) out.push_back({p.vertices[v], v, 0});
  }
}

/// One convex body against the convex regions of a surface.
class ConvexOnMesh {
 public:
  void collide(const MeshGuest& guest, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
               const PairQuery& q, ContactSink& sink) {
    guest_ = &guest;
    mesh_ = &mesh;
    sink_ = &sink;
    const Pose pose{q.b.to_local(q.a.position), q.b.orientation.conjugate() * q.a.orientation};
    const double size = guest.core.radius + guest.sweep;
    b_ = {guest.core, guest.sweep,
          pose,       pose.orientation.toRotationMatrix(),
          q.reach,    std::max(on_surface * size, mesh.joined.unevenness),
          &mesh};
    springs_ = !(q.reach > 0.0);
    out_.clear();
    beyond_.clear();
    // of a plane any triangle will do: its closed form tells whether the body is near
    bool plain = all_plain(mesh, triangles);
    if (!plain) plain = all_plain(mesh, triangles = find_near(triangles));
    if (triangles.empty()) return;
    const std::uint32_t face = mesh.face[triangles.front()];  // the same triangle whichever is near, for the same bits
    if (plain)
      on_face(face, normal_towards(mesh, face, pose.position), Face::plain);
    else
      meet_regions();
    if (out_.empty() && !beyond_.empty()) out_.push_back(*std::ranges::min_element(beyond_, {}, &MeshPoint::gap));
    join_smooth();
    reduce(out_, size, mesh.joined.flatness, springs_);
    const auto radius_towards = [&](const Vec3& n) {
      return guest.radius.against_flat(pose.orientation.conjugate() * n);
    };
    emit(out_, pose.position, radius_towards, q, sink);
  }

 private:
  std::span<const std::uint32_t> find_near(std::span<const std::uint32_t> candidates) {
    near_.clear();
    std::ranges::copy_if(candidates, std::back_inserter(near_), [&](std::uint32_t t) { return is_near(b_, t); });
    return near_;
  }

  /// With the neighbours where the surface bends: the way out may lean on a face beyond a blunt edge.
  void meet_regions() {
    triangles_ = near_;
    for (const std::uint32_t t : near_)
      for (std::size_t side = 0; side < 3; ++side)
        if (mesh_->edge_kinds[t][side] != EdgeKind::open) triangles_.push_back(mesh_->neighbours[t][side]);
    std::ranges::sort(triangles_);
    triangles_.erase(std::unique(triangles_.begin(), triangles_.end()), triangles_.end());
    find_sides(*mesh_, triangles_, b_.pose.position, fronts_);
    ways_.clear();
    members_.clear();
    leaning_.clear();
    const auto meet = [&](std::uint32_t t, bool last) {
      gather_region(b_, triangles_, t, fronts_[place_of(triangles_, t)], region_);
      for (const std::uint32_t member : region_.triangles) members_.emplace_back(member, ways_.size());
      const std::size_t before = out_.size();
      const WayOut way = meet_region(last);
      ways_.push_back(out_.size() > before ? way : WayOut{infinity, Vec3::Zero(), Vec3::Zero(), 0.0});
    };
    for (const std::uint32_t t : near_)
      if (std::ranges::find(members_, t, &Member::first) == members_.end()) meet(t, false);
    for (const std::uint32_t t : leaning_) meet(t, true);
  }

  /// Adds the contacts along the shortest way out of the region, which it returns; on a face where its plane is as
  /// good, within the tolerance. A way that leans on others is left for last: what it leans on may hold the body.
  WayOut meet_region(bool last) {
    WayOut way = find_way_out(b_, region_);
    if (!(way.gap - b_.sweep < b_.reach)) return way;
    const RegionPlane& best = best_plane();
    bool bent = is_bent(way, best);
    if (bent && (!is_on_surface(way.on_mesh) || leans_on_others(way)) && continue_rims(b_, region_)) {
      way = find_way_out(b_, region_);
      bent = is_bent(way, best);
    }
    if (way.uncertainty > narrow_enough * std::max(b_.core.radius, region_.radius)) sink_->mark_degenerate();
    if (bent && !is_on_surface(way.on_mesh)) return way;
    const std::size_t before = out_.size();
    if (bent && is_known(way)) return way;
    const bool leans = bent && leans_on_others(way);
    if (leans && !last) {
      leaning_.push_back(region_.first);
      return way;
    }
    if (bent && !leans) {
      on_edge(way);
      on_face_beside(way, before);
    } else {
      on_face(best.triangle, best.normal, leans ? Face::leaning : Face::bent);
      if (leans && out_.size() == before) {  // all ways out may lean on others: edges that end in a notch
        hold_deepest(way, before);
        beyond_.insert(beyond_.end(), out_.begin() + static_cast<std::ptrdiff_t>(before), out_.end());
        out_.resize(before);
      }
      way = {best.gap, best.normal, way.on_mesh, 0.0};
    }
    if (!leans) hold_deepest(way, before);
    return way;
  }

  /// The points of an edge or corner of the region, along the way out.
  void on_edge(const WayOut& way) {
    const Mat3 to_body = b_.turn.transpose();
    const Vec3 n = -(to_body * way.normal);
    const double gap = way.gap - b_.sweep;
    std::uint32_t owner = region_.first;
    corners_.clear();
    for (const std::uint32_t t : region_.triangles)
      for (const Vec3& c : mesh_->corners(t)) {
        if (!(way.normal.dot(c - way.on_mesh) > -b_.tolerance)) continue;
        if (corners_.empty()) owner = t;
        corners_.push_back({to_body * (c - b_.pose.position), 0, 0});
      }
    FlatSide edge;
    if (!corners_.empty()) {
      const auto farthest_from = [&](const Vec3& x) {
        return std::ranges::max_element(corners_, {}, [&](const SidePoint& p) { return (p.x - x).squaredNorm(); })->x;
      };
      edge.corner[0] = farthest_from(corners_.front().x);
      edge.corner[1] = farthest_from(edge.corner[0]);
      edge.count = (edge.corner[1] - edge.corner[0]).norm() > b_.tolerance ? 2 : 0;
    }
    const Patch patch = patch_on(edge, {to_body * (way.on_mesh - b_.pose.position) - 0.5 * gap * n, n, gap});
    for (int k = 0; k < patch.count; ++k) {
      const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
      const Vec3 x = b_.pose.position + b_.turn * p.position;
      out_.push_back({x, way.normal, std::max(p.gap, gap), mesh_feature(owner, local_name(p.feature))});
    }
  }
  /// The side that the body turns to an edge, both in its axes.
  Patch patch_on(const FlatSide& edge, const NearestPoint& nearest) const {
    const auto itself = [](const void* e, const Vec3&) { return *static_cast<const FlatSide*>(e); };
    const double size = b_.core.radius;
    if (guest_->polyhedron)
      return core_patch({*guest_->polyhedron, Mat3::Identity(), Vec3::Zero(), &edge, itself, size}, nearest, b_.reach,
                        b_.sweep, 0.0);
    const FlatSide own = guest_->facing ? guest_->facing(guest_->shape, nearest.normal) : FlatSide{};
    return flat_patch({own, edge, size, b_.sweep, 0.0}, nearest, b_.reach);
  }

  /// Where the deepest point of the body hangs over a rim, or lies between the corners of a round end, the region's own
  /// point next to it holds it; not where another triangle stands between that and the body, as the near side of a
  /// plate thinner than the overlap.
  void hold_deepest(const WayOut& way, std::size_t before) {
    const double gap = way.gap - b_.sweep;
    const auto holds = [&](const MeshPoint& p) { return p.gap <= gap + b_.tolerance; };
    const auto beside = [&](const MeshPoint& p) { return holds(p) && p.normal.dot(way.normal) > one_spot; };
    if (std::any_of(out_.begin() + static_cast<std::ptrdiff_t>(before), out_.end(), holds)) return;
    if (std::ranges::any_of(beyond_, beside)) return;
    NearestOnTriangle nearest{Vec3::Zero(), infinity, TrianglePart::face};
    for (const std::uint32_t t : region_.triangles) {
      const NearestOnTriangle here = nearest_on_triangle(way.on_mesh, mesh_->corners(t));
      if (here.distance < nearest.distance) nearest = here;
    }
    const Vec3 above = nearest.point + way.normal * way.normal.dot(b_.pose.position - nearest.point);
    const auto hides = [&](std::uint32_t t) { return stands_between(*mesh_, t, above, nearest.point, b_.tolerance); };
    if (std::ranges::any_of(triangles_, hides)) return;
    const std::uint32_t name = local_name(make_feature(FeatureKind::single, 0, region_.front));
    out_.push_back({nearest.point + 0.5 * gap * way.normal, way.normal, gap, mesh_feature(region_.first, name)});
  }

  /// True for walls around a notch, seen from behind: they bend away from each other, but enclose nothing.
  bool is_on_surface(const Vec3& x) const {
    return std::ranges::any_of(triangles_, [&](std::uint32_t t) { return lies_on(*mesh_, t, x, 10.0 * b_.tolerance); });
  }
  /// The way out is shorter than along the best plane; a plane within 1e-5 rad of it is used instead.
  bool is_bent(const WayOut& way, const RegionPlane& best) const {
    const bool along = way.normal.cross(best.normal).squaredNorm() <= along_face * along_face;
    return best.gap < way.gap - (along ? b_.tolerance : 1e-3 * b_.tolerance + 1e-12 * region_.radius);
  }
  /// True if the way out begins on the line of a rim of the region, and leaves both of its faces: whatever else meets
  /// the rim there.
  bool is_on_rim(const WayOut& way) const {
    bool found = false;
    each_rim(*mesh_, region_, [&](std::uint32_t t, std::size_t k) {
      const auto corner = mesh_->corners(t);
      const Vec3 along = (corner[(k + 1) % 3] - corner[k]).normalized(), w = way.on_mesh - corner[k];
      const Vec3 &m = mesh_->normals[t], &n = mesh_->normals[mesh_->neighbours[t][k]];
      const Vec3 out = region_.front ? way.normal : Vec3(-way.normal), turn = m.cross(n);
      found = found || (std::abs(out.dot(along)) <= along_face && w.cross(along).norm() <= 10.0 * b_.tolerance &&
                        m.cross(out).dot(turn) >= 0.0 && out.cross(n).dot(turn) >= 0.0);
    });
    return found;
  }
  const RegionPlane& best_plane() {
    for (RegionPlane& p : region_.planes) p.gap = p.normal.dot(b_.tip(-p.normal) - p.point);
    return *std::ranges::max_element(region_.planes, {}, &RegionPlane::gap);
  }
  /// True if a triangle outside the region extends there along the way out, so that the body would move into it or
  /// along the surface: a concave or an inner edge.
  bool leans_on_others(const WayOut& way) const {
    const Vec3& x = way.on_mesh;
    const auto reaches_out = [&](const Vec3& c) {  // flat within 1e-6 rad is not reaching out
      return way.normal.dot(c - x) > 1e-3 * b_.tolerance + 1e-6 * (c - x).norm();
    };
    return !is_on_rim(way) && std::ranges::any_of(triangles_, [&](std::uint32_t t) {
      return !std::ranges::binary_search(region_.triangles, t) && lies_on(*mesh_, t, x, 10.0 * b_.tolerance) &&
             std::ranges::any_of(mesh_->corners(t), reaches_out);
    });
  }
  /// True if another region that contains the point is as deep there.
  bool is_known(const WayOut& way) const {
    return std::ranges::any_of(members_, [&](const Member& member) {
      if (member.second >= ways_.size() || !lies_on(*mesh_, member.first, way.on_mesh, b_.tolerance)) return false;
      const WayOut& known = ways_[member.second];
      return known.gap <= way.gap + b_.tolerance && known.normal.dot(way.normal) > same_edge_cosine;
    });
  }

  /// Whether the body sees a plane; a face whose region lets it out sooner, but onto others, or a face with edges.
  enum class Face { plain, leaning, bent };
  /// The points on the plane of t, towards n: those of the closed form if all of them are over its face. Else the
  /// corners that are, and where a side of the body is cut at its rim.
  void on_face(std::uint32_t t, const Vec3& n, Face kind) {
    const Vec3& point = mesh_->vertices[mesh_->triangles[t][0]];
    const std::size_t before = out_.size();
    on_plane_.clear();
    ContactSink sink(on_plane_);
    guest_->on_plane(guest_->shape, HalfSpace{n}, {b_.pose, {point, Quat(1, 0, 0, 0)}, b_.reach, false, nullptr}, sink);
    for (std::size_t k = 0; k < on_plane_.size(); ++k) {
      const Vec3 x = b_.pose.position + on_plane_.arm[k];
      const MeshPoint p{x, n, on_plane_.gap[k], mesh_feature(mesh_->face[t], local_name(on_plane_.feature[k]))};
      if (kind == Face::plain || (is_over(t, x) && came_through(t, n, x + (0.5 * on_plane_.gap[k]) * n)))
        out_.push_back(p);
      else if (!is_over(t, x) && goes_on(t, n, x))
        beyond_.push_back(p);
    }
    if (kind == Face::plain) return;
    place(side_along, n, side_);
    const auto is_beside = [&](const SidePoint& p) { return !is_over(t, p.x); };
    if (out_.size() == before + on_plane_.size() && std::ranges::none_of(side_, is_beside)) return;
    if (side_.size() < 2) return;
    out_.resize(before);
    lay_side(t, {n, n, point, -infinity, 1.0}, kind);
  }
  /// A plane, the direction along which gaps from it count, and the least of them.
  struct Slope {
    Vec3 plane, along, point;
    double least;
    double cosine = plane.dot(along);

    double height(const Vec3& x) const { return plane.dot(x - point) / cosine; }
    Vec3 foot(const Vec3& x) const { return x - height(x) * along; }
  };
  /// What the body turns along a way out over the face of t, and where that is cut at its rim.
  void lay_side(std::uint32_t t, const Slope& slope, Face kind) {
    place(corners_along, slope.along, corners_);
    for (const SidePoint& p : corners_)
      if (is_over(t, slope.foot(p.x)) && came_through(t, slope.plane, p.x)) add(t, slope, p);
    for (const std::uint32_t member : region_.triangles) {
      if (mesh_->face[member] != mesh_->face[t]) continue;
      corners_ = side_;
      const Triangle& corner = mesh_->triangles[member];
      const Vec3 up = mesh_->normals[member].dot(slope.along) < 0.0 ? Vec3(-slope.along) : slope.along;
      clip_side([&](std::uint32_t k) -> const Vec3& { return mesh_->vertices[corner[k]]; }, 3, up, b_.tolerance,
                corners_);
      for (const SidePoint& p : corners_) {
        const Cut cut = p.cut == 0 ? Cut::inside : cut_at(member, slope.foot(p.x));
        if (cut == Cut::inside) continue;
        if ((cut == Cut::rim && kind == Face::bent) || came_through(member, slope.plane, p.x)) add(member, slope, p);
      }
    }
  }
  /// Over an edge or corner of the region a flat side that leans on the face beside it touches there too, or all its
  /// points would come at once, and deep, when it lies (core_patch.h, of a polyhedron). The points of the edge remain
  /// where none of these is as deep.
  void on_face_beside(const WayOut& way, std::size_t before) {
    constexpr double leaning = 0.9;  // cosine: as far as sides do
    const auto cosine = [&](const RegionPlane& p) { return p.normal.dot(way.normal); };
    const RegionPlane& face = *std::ranges::max_element(region_.planes, {}, cosine);
    place(side_along, way.normal, side_);
    if (side_.size() < 2 || !(cosine(face) > leaning)) return;
    const auto edge_end = static_cast<std::ptrdiff_t>(out_.size());
    const double gap = way.gap - b_.sweep;
    lay_side(face.triangle, {face.normal, way.normal, face.point, gap}, Face::bent);
    const auto laid = std::ranges::subrange(out_.begin() + edge_end, out_.end());
    if (laid.empty()) return;
    const double least = std::ranges::min_element(laid, {}, &MeshPoint::gap)->gap;
    if (least > gap + std::max(b_.tolerance, -0.1 * gap)) return;  // as keep_with_nearest
    for (MeshPoint& p : laid) p.gap += gap - least;
    out_.erase(out_.begin() + static_cast<std::ptrdiff_t>(before), out_.begin() + edge_end);
  }
  /// Where a side of the body was cut: inside the face (no corner of what they share), at its rim, at a concave edge.
  enum class Cut { inside, rim, concave };
  Cut cut_at(std::uint32_t t, const Vec3& x) const {
    Cut cut = Cut::inside;
    const auto corner = mesh_->corners(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const EdgeKind kind = mesh_->edge_kinds[t][k];
      if (kind == EdgeKind::flat || std::abs(mesh_->inward[t][k].dot(x - corner[k])) > 2.0 * b_.tolerance) continue;
      if (kind != (region_.front ? EdgeKind::concave : EdgeKind::convex)) return Cut::rim;
      cut = Cut::concave;
    }
    return cut;
  }
  /// What the body turns against n, in the mesh's axes.
  template <class Along>
  void place(const Along& along, const Vec3& n, std::vector<SidePoint>& out) const {
    out.clear();
    along(*guest_, -(b_.turn.transpose() * n), out);
    for (SidePoint& p : out) p.x = b_.pose.position + b_.turn * p.x;
  }
  void add(std::uint32_t t, const Slope& slope, const SidePoint& p) {
    const double gap = std::max(slope.least, slope.height(p.x) - b_.sweep);
    if (!(gap < b_.reach)) return;
    const Vec3& n = slope.along;
    const bool corner = p.cut == 0;
    const Feature name = make_feature(corner ? FeatureKind::vertex_a : FeatureKind::edges, p.corner, 0);
    out_.push_back(
        {p.x - (b_.sweep + 0.5 * gap) * n, n, gap, mesh_feature(corner ? mesh_->face[t] : t, local_name(name, p.cut))});
  }
  /// The plane of t goes on to x over smooth concave edges of its face.
  bool goes_on(std::uint32_t face, const Vec3& n, const Vec3& x) const {
    return std::ranges::any_of(region_.triangles, [&](std::uint32_t t) {
      return mesh_->face[t] == mesh_->face[face] && goes_on_to(*mesh_, t, n, x, springs_, b_.tolerance);
    });
  }
  /// The triangle is of the smooth surface of that face and rises above its plane: a hollow.
  bool holds_too(std::uint32_t face, const Vec3& n, std::uint32_t t) const {
    if (smooth_around(*mesh_, t, springs_) != smooth_around(*mesh_, face, springs_)) return false;
    const auto corner = mesh_->corners(t);
    return n.dot(corner[0] + corner[1] + corner[2] - 3.0 * mesh_->vertices[mesh_->triangles[face][0]]) > 0.0;
  }
  /// A point of the body touches a smooth surface once: out of all its planes.
  void join_smooth() {
    const auto tip = [&](const MeshPoint& p) -> Vec3 { return p.position + (b_.sweep + 0.5 * p.gap) * p.normal; };
    std::ranges::sort(out_, {}, [](const MeshPoint& p) { return std::pair(p.gap, p.feature); });
    for (std::size_t i = 0; i < out_.size() && out_[i].gap < 0.0; ++i) {
      MeshPoint& p = out_[i];
      double radius = 0.0;  // of curvature of the body's core there
      walls_.clear();
      const auto joins = [&](const MeshPoint& o) {
        const std::uint32_t s = triangle_of(p.feature), t = triangle_of(o.feature);
        const double cosine = p.normal.dot(o.normal);
        if (mesh_->face[s] == mesh_->face[t] || local_of(p.feature) != local_of(o.feature) || !(cosine > 0.0) ||
            !holds_too(s, p.normal, t))
          return false;
        if (!(o.gap < cosine * p.gap)) return true;
        walls_.push_back(p.gap / o.gap * o.normal);
        const Vec3 turn = p.normal - o.normal;
        radius = turn.dot(tip(o) - tip(p)) / turn.squaredNorm();
        return true;
      };
      std::ranges::for_each(beyond_, joins);
      out_.erase(std::remove_if(out_.begin() + static_cast<std::ptrdiff_t>(i) + 1, out_.end(), joins), out_.end());
      if (walls_.empty()) continue;
      const Vec3 way = nearest_of_hull(p.normal, walls_), end = tip(p) + radius * p.normal;
      p.gap /= way.norm();
      p.normal = way.normalized();
      p.position = end - (radius + b_.sweep + 0.5 * p.gap) * p.normal;
    }
  }
  bool is_over(std::uint32_t face, const Vec3& x) const {
    return std::ranges::any_of(region_.triangles, [&](std::uint32_t t) {
      return mesh_->face[t] == mesh_->face[face] && over_triangle(*mesh_, t, x).beyond <= b_.tolerance;
    });
  }
  /// True if the body has reached x, behind the face of t, through that face first. Otherwise x belongs to the surface
  /// beyond an edge: a corner of a box on a table is also behind the table's side.
  bool came_through(std::uint32_t face, const Vec3& n, const Vec3& x) const {
    const Vec3& point = mesh_->vertices[mesh_->triangles[face][0]];
    const Vec3& centre = b_.pose.position;
    const double from = n.dot(centre - point), to = n.dot(x - point);
    if (!(to < -b_.tolerance)) return true;
    const Vec3 gate = centre + from / (from - to) * (x - centre);
    bool through = false;
    for (const std::uint32_t t : triangles_) {
      if (mesh_->face[t] == mesh_->face[face])
        through = through || goes_on_to(*mesh_, t, n, gate, springs_, b_.tolerance);
      else if (!holds_too(face, n, t) && stands_between(*mesh_, t, centre, gate, b_.tolerance))
        return false;
    }
    return through;
  }

  const MeshGuest* guest_ = nullptr;
  const TriangleMesh* mesh_ = nullptr;
  ContactSink* sink_ = nullptr;
  PlacedCore b_{};
  bool springs_ = true;
  // they keep their sizes: no allocation once the largest contact was seen
  std::vector<std::uint32_t> near_, triangles_, leaning_;
  std::vector<unsigned char> fronts_;  ///< by place: the body is on the front of the surface there
  std::vector<WayOut> ways_;           ///< by region
  using Member = std::pair<std::uint32_t, std::size_t>;
  std::vector<Member> members_;  ///< triangles and the regions that they are in
  std::vector<SidePoint> side_, corners_;
  /// beyond_: where the face itself does not hold the body; one remains if no face does
  std::vector<MeshPoint> out_, beyond_;
  std::vector<Vec3> walls_;  ///< of one contact: points of planes
  ContactSet on_plane_;
  MeshRegion region_;
};

}  // namespace

void collide_guest(const MeshGuest& guest, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                   const PairQuery& q, ContactSink& sink) {
  static thread_local ConvexOnMesh pair;
  pair.collide(guest, mesh, triangles, q, sink);
}

}  // namespace epafi
