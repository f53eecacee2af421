#include "detection/narrow/on_surface.h"

#include <algorithm>
#include <cmath>

#include "detection/narrow/gjk/gjk.h"
#include "detection/narrow/mesh/mesh_region.h"
#include "detection/narrow/pairs/part_pairs.h"

namespace epafi {

namespace {

template <class S>
concept FlatConvex = PolyhedralShape<S> || HasFlatSides<S>;

template <ConvexShape S>
bool reaches_beyond(const S& s, const Vec3& point, const Vec3& normal, double near) {
  return normal.dot(s.support(normal) - point) + s.rounding() > near;
}

ConvexRef ref_of_a_point() {
  return {nullptr, [](const void*, const Vec3&) { return Vec3(Vec3::Zero()); }, 0.0};
}

/// Collects normals of sides and keeps the one nearest to a direction.
class NearestNormal {
 public:
  explicit NearestNormal(const Vec3& normal) : given_(normal), best_(normal) {}
  void see(const Vec3& n) {
    const double cosine = n.dot(given_);
    if (!(cosine > most_)) return;
    most_ = cosine;
    best_ = n;
  }
  const Vec3& best() const { return best_; }
  bool is_best(const Vec3& n) const { return n.dot(best_) > 1.0 - 1e-9; }

 private:
  Vec3 given_, best_;
  double most_ = std::sqrt(1.0 - facing_sine * facing_sine);
};

/// Properties of a shape for seams; none for shapes without flat faces.
template <class S>
struct Piece {
  static constexpr bool flat = false;
  static double distance(const S&, const Vec3&, double) { return infinity; }
  static bool beyond(const S&, const Vec3&, const Vec3&, double) { return false; }
  static Vec3 side_normal(const S&, const Vec3&, const Vec3& normal, double) { return normal; }
};

template <PolyhedralShape S>
struct Piece<S> {
  static constexpr bool flat = true;
  static double distance(const S& s, const Vec3& point, double near) {
    const PolyhedronView view = s.view();
    double out = -infinity;
    for (std::size_t k = 0; k < view.face_normals.size(); ++k) {
      out = std::max(out, view.face_normals[k].dot(point) - view.face_offsets[k] - s.rounding());
      if (out > near) return infinity;
    }
    return out;
  }
  static bool beyond(const S& s, const Vec3& point, const Vec3& normal, double near) {
    return reaches_beyond(s, point, normal, near);
  }
  static Vec3 side_normal(const S& s, const Vec3& point, const Vec3& normal, double near) {
    const PolyhedronView view = s.view();
    NearestNormal nearest(normal);
    for (const Vec3& n : view.face_normals) nearest.see(n);
    for (std::size_t k = 0; k < view.face_normals.size(); ++k) {
      const double height = view.face_normals[k].dot(point) - view.face_offsets[k] - s.rounding();
      if (height > -near && !nearest.is_best(view.face_normals[k])) return normal;
    }
    return nearest.best();
  }
};

template <FlatConvex S>
requires(!PolyhedralShape<S>) struct Piece<S> {
  static constexpr bool flat = true;
  static double distance(const S& s, const Vec3& point, double near) {
    const MinkowskiDifference difference(ConvexRef::to(s), ref_of_a_point(), Mat3::Identity(), point);
    const GjkResult found = gjk(difference, {near + s.rounding(), 1e-12, point});
    if (found.status == GjkResult::Status::overlapping) return 0.0;
    return found.status == GjkResult::Status::beyond ? infinity : found.upper - s.rounding();
  }
  static bool beyond(const S& s, const Vec3& point, const Vec3& normal, double near) {
    return reaches_beyond(s, point, normal, near);
  }
  static Vec3 side_normal(const S& s, const Vec3& point, const Vec3& normal, double near) {
    const FlatSide side = s.facing(normal);
    if (side.count < 2) return normal;
    const Vec3 along = (side.corner[1] - side.corner[0]).normalized();
    if (side.count == 2) {
      const double at = along.dot(point - side.corner[0]), length = along.dot(side.corner[1] - side.corner[0]);
      return at > near && at < length - near ? Vec3((normal - normal.dot(along) * along).normalized()) : normal;
    }
    Vec3 n = along.cross(side.corner[2] - side.corner[0]).normalized(), middle = Vec3::Zero();
    for (int k = 0; k < side.count; ++k) middle += side.corner[static_cast<std::size_t>(k)] / side.count;
    if (n.dot(normal) < 0.0) n = -n;
    const Vec3 out = point - middle;  // of a round end
    return (out - n.dot(out) * n).norm() < (side.corner[0] - middle).norm() - near ? n : normal;
  }
};

template <>
struct Piece<HalfSpace> {
  static constexpr bool flat = true;
  static double distance(const HalfSpace& s, const Vec3& point, double) { return s.normal.dot(point); }
  static bool beyond(const HalfSpace& s, const Vec3&, const Vec3& normal, double) {
    return s.normal.dot(normal) < 1.0 - 1e-12;
  }
  static Vec3 side_normal(const HalfSpace& s, const Vec3&, const Vec3& normal, double) {
    NearestNormal nearest(normal);
    nearest.see(s.normal);
    return nearest.best();
  }
};

template <>
struct Piece<TriangleMesh> {
  static constexpr bool flat = true;
  static double distance(const TriangleMesh& s, const Vec3& point, double near) {
    double least = infinity;
    each_near(s, point, near, [&](std::uint32_t, double distance) { least = std::min(least, distance); });
    return least;
  }
  static bool beyond(const TriangleMesh& s, const Vec3& point, const Vec3& normal, double near) {
    bool any = false;
    each_near(s, point, near, [&](std::uint32_t t, double) {
      for (const Vec3& corner : s.corners(t)) any = any || normal.dot(corner - point) > near;
    });
    return any;
  }
  static Vec3 side_normal(const TriangleMesh& s, const Vec3& point, const Vec3& normal, double near) {
    NearestNormal nearest(normal);
    bool inside = true;
    each_near(s, point, near, [&](std::uint32_t t, double) {
      nearest.see(s.normals[t].dot(normal) < 0.0 ? Vec3(-s.normals[t]) : s.normals[t]);
      const auto corners = s.corners(t);
      for (std::size_t k = 0; k < 3; ++k)
        inside = inside && (s.edge_kinds[t][k] == EdgeKind::flat || s.inward[t][k].dot(point - corners[k]) > near);
    });
    return inside ? nearest.best() : normal;
  }
  template <class F>
  static void each_near(const TriangleMesh& s, const Vec3& point, double near, const F& f) {
    static thread_local std::vector<std::uint32_t> triangles;
    triangles.clear();
    s.query(Aabb{point, point}.fattened(near), triangles);
    for (const std::uint32_t t : triangles) {
      const double distance = nearest_on_triangle(point, s.corners(t)).distance;
      if (distance <= near) f(t, distance);
    }
  }
};

/// The outline counts, in the half plane through the point: a wall lies in its tangents, along the side, and across a
/// closed end.
template <HollowShape S>
struct Piece<S> {
  static constexpr bool flat = true;
  static double distance(const S& s, const Vec3& point, double) { return s.wall.distance(point); }
  static Vec3 side_normal(const S&, const Vec3&, const Vec3& normal, double) { return normal; }
  static bool beyond(const S& s, const Vec3& point, const Vec3& normal, double near) {
    const HollowWall& wall = s.wall;
    const double radius = std::sqrt(point.x() * point.x() + point.y() * point.y());
    const Vec3 out = radius > 0.0 ? Vec3(point.x() / radius, point.y() / radius, 0.0) : Vec3(Vec3::UnitX());
    const double around = normal.y() * out.x() - normal.x() * out.y(), across = normal.dot(out);
    const double way = std::clamp(wall.way_along(radius, point.z()), 0.0, wall.side_length);
    // directions that seams take for the same are level, so that of two rims one keeps the contact
    constexpr double level = 4e-5;
    const auto reaches = [&](double along, double length) { return along > level && along * length > near; };
    const auto distance_in_plane = [&](double r, double z) {
      return std::sqrt((radius - r) * (radius - r) + (point.z() - z) * (point.z() - z));
    };
    if (distance_in_plane(wall.radius_at(way), wall.along_z * way - wall.half_length) <= near) {
      const double along = wall.along_radius * across + wall.along_z * normal.z();
      if (reaches(along, wall.side_length - way) || reaches(-along, way) || reaches(std::abs(around), radius))
        return true;
    }
    for (const bool at_end : {false, true}) {
      const double rim = wall.radius_of_end(at_end), z = wall.z_of_end(at_end);
      if (!wall.closed || distance_in_plane(std::min(radius, rim), z) > near) continue;
      if (reaches(-across, radius + rim) || reaches(across, rim - radius) || reaches(std::abs(around), rim))
        return true;
    }
    return false;
  }
};

template <class S>
concept FlatParts = Compound<S> && FlatConvex<typename S::Part>;

template <FlatParts S>
struct Piece<S> {
  using Of = Piece<typename S::Part>;
  static constexpr bool flat = true;
  static double distance(const S& s, const Vec3& point, double near) {
    double least = infinity;
    for (std::size_t k = 0; k < s.part_count(); ++k) least = std::min(least, distance(s, k, point, near));
    return least;
  }
  static bool beyond(const S& s, const Vec3& point, const Vec3& normal, double near) {
    for (std::size_t k = 0; k < s.part_count(); ++k)
      if (distance(s, k, point, near) <= near && beyond(s, k, point, normal, near)) return true;
    return false;
  }
  static double distance(const S& s, std::size_t k, const Vec3& point, double near) {
    const bool may_be_near = s.parts[k].box.fattened(near).contains(Aabb{point, point});
    return may_be_near ? Of::distance(s.part(k), point - centre(s, k), near) : infinity;
  }
  static bool beyond(const S& s, std::size_t k, const Vec3& point, const Vec3& normal, double near) {
    return Of::beyond(s.part(k), point - centre(s, k), normal, near);
  }
  static Vec3 side_normal(const S&, const Vec3&, const Vec3& normal, double) { return normal; }
  static Vec3 side_normal(const S& s, std::size_t k, const Vec3& point, const Vec3& normal, double near) {
    return Of::side_normal(s.part(k), point - centre(s, k), normal, near);
  }

 private:
  static const Vec3& centre(const S& s, std::size_t k) { return s.parts[k].centre; }  // not turned against the body
};

}  // namespace

bool has_flat_faces(const ShapeStore& shapes, ShapeRef shape) {
  return shapes.with(shape, []<class S>(const S&) { return Piece<S>::flat; });
}

bool is_free_wall(const ShapeStore& shapes, ShapeRef shape) {
  return has_flat_faces(shapes, shape) && shape.type() != ShapeStore::type_of<Capsule>();
}

bool is_convex(const ShapeStore& shapes, ShapeRef shape) {
  return shapes.with(shape, []<class S>(const S&) { return ConvexShape<S> || std::is_same_v<S, HalfSpace>; });
}

std::size_t part_count(const ShapeStore& shapes, ShapeRef shape) {
  return shapes.with(shape, []<class S>(const S& s) -> std::size_t {
    if constexpr (FlatParts<S>) return s.part_count();
    return 0;
  });
}

double distance_to(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, double near) {
  const Vec3 local = piece.pose.to_local(point);
  return shapes.with(piece.shape, [&]<class S>(const S& s) {
    if constexpr (FlatParts<S>)
      if (piece.part != WallPiece::whole) return Piece<S>::distance(s, piece.part, local, near);
    return Piece<S>::distance(s, local, near);
  });
}

void find_parts(const ShapeStore& shapes, const WallPiece& solid, const Vec3& point, double near,
                std::vector<std::size_t>& out) {
  out.clear();
  const Vec3 local = solid.pose.to_local(point);
  shapes.with(solid.shape, [&]<class S>(const S& s) {
    if constexpr (FlatParts<S>)
      for (std::size_t k = 0; k < s.part_count(); ++k)
        if (Piece<S>::distance(s, k, local, near) <= near) out.push_back(k);
  });
}

bool goes_beyond(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, const Vec3& normal, double near) {
  const Vec3 local = piece.pose.to_local(point), direction = piece.pose.orientation.conjugate() * normal;
  return shapes.with(piece.shape, [&]<class S>(const S& s) {
    if constexpr (FlatParts<S>)
      if (piece.part != WallPiece::whole) return Piece<S>::beyond(s, piece.part, local, direction, near);
    return Piece<S>::beyond(s, local, direction, near);
  });
}

Vec3 side_normal(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, const Vec3& normal, double near) {
  const Vec3 local = piece.pose.to_local(point), direction = piece.pose.orientation.conjugate() * normal;
  const Vec3 found = shapes.with(piece.shape, [&]<class S>(const S& s) {
    if constexpr (FlatParts<S>)
      if (piece.part != WallPiece::whole) return Piece<S>::side_normal(s, piece.part, local, direction, near);
    return Piece<S>::side_normal(s, local, direction, near);
  });
  return piece.pose.orientation * found;
}

PlaneSide plane_side(const ShapeStore& shapes, const WallPiece& piece, const Vec3& normal, const Vec3& point,
                     const Vec3& centre, double reach) {
  const Vec3 at = piece.pose.to_local(point), body = piece.pose.to_local(centre),
             n = piece.pose.orientation.conjugate() * normal;
  const double most_turned = std::sqrt(1.0 - facing_sine * facing_sine);
  PlaneSide found{normal};
  shapes.with(piece.shape, [&]<class S>(const S& s) {
    double least = infinity;
    const auto see = [&](const Vec3& side, double offset) {
      const double off = std::abs(side.dot(at) - offset) + reach * (side - n).norm();
      if (!(off < least) || !(side.dot(n) > most_turned)) return;
      least = off;
      found = {side, offset};
    };
    const auto see_faces = [&](const auto& polyhedron, const Vec3& middle) {
      const PolyhedronView view = polyhedron.view();
      for (std::size_t k = 0; k < view.face_normals.size() && !(polyhedron.rounding() > 0.0); ++k)
        see(view.face_normals[k], view.face_offsets[k] + view.face_normals[k].dot(middle));
    };
    if constexpr (PolyhedralShape<S>) see_faces(s, Vec3::Zero());
    if constexpr (FlatParts<S> && PolyhedralShape<PartOf<S>>)
      for (std::size_t k = 0; k < s.part_count(); ++k) {
        const Vec3 middle = s.parts[k].centre;
        if ((middle - body).norm() <= s.part(k).bounding_radius() + reach) see_faces(s.part(k), middle);
      }
    if constexpr (std::is_same_v<S, TriangleMesh>) {
      static thread_local std::vector<std::uint32_t> triangles;  // they keep their sizes
      static thread_local std::vector<unsigned char> fronts;
      triangles.clear();
      Piece<S>::each_near(s, body, reach, [&](std::uint32_t t, double) { triangles.push_back(t); });
      const auto faces = [&](std::uint32_t t) { return std::abs(s.normals[t].dot(n)) > most_turned; };
      if (std::ranges::none_of(triangles, faces)) return;
      find_sides(s, triangles, body, fronts);
      for (std::size_t k = 0; k < triangles.size(); ++k) {
        const std::uint32_t t = triangles[k];
        const Vec3 side = fronts[k] != 0 ? s.normals[t] : Vec3(-s.normals[t]);
        see(side, side.dot(s.vertices[s.triangles[t][0]]));
      }
    }
  });
  if (std::isfinite(found.offset)) found.normal = piece.pose.orientation * found.normal;
  return found;
}

}  // namespace epafi
