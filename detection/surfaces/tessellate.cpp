#include "detection/surfaces/tessellate.h"

#include <cmath>
#include <numbers>

#include "engine/state/frame.h"

namespace epafi {
namespace {

/// A point of a profile that turns about z.
struct Ring {
  double radius, z;
};

/// Surface of revolution; the rings run from the lowest to the highest, the first and the last have radius 0.
TriangleSurface revolve(const std::vector<Ring>& rings, std::uint32_t segments) {
  TriangleSurface s;
  const auto inner = static_cast<std::uint32_t>(rings.size() - 2);
  s.vertices.emplace_back(0.0, 0.0, rings.front().z);
  for (std::uint32_t r = 1; r <= inner; ++r)
    for (std::uint32_t k = 0; k < segments; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / segments;
      s.vertices.emplace_back(rings[r].radius * std::cos(angle), rings[r].radius * std::sin(angle), rings[r].z);
    }
  s.vertices.emplace_back(0.0, 0.0, rings.back().z);
  const auto top = static_cast<std::uint32_t>(s.vertices.size() - 1);
  const auto at = [&](std::uint32_t ring, std::uint32_t k) { return 1 + ring * segments + k % segments; };
  for (std::uint32_t k = 0; k < segments; ++k) {
    s.triangles.push_back({0, at(0, k + 1), at(0, k)});
    for (std::uint32_t r = 0; r + 1 < inner; ++r) {
      s.triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k + 1)});
      s.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r + 1, k)});
    }
    s.triangles.push_back({at(inner - 1, k), at(inner - 1, k + 1), top});
  }
  return s;
}

/// Two half circles of radius r whose centres lie at -h and h; with h = 0 one circle without a doubled equator.
std::vector<Ring> rounded_profile(double r, double h, std::uint32_t segments) {
  const std::uint32_t quarter = std::max(1u, segments / 4);
  std::vector<Ring> rings;
  const auto arc = [&](std::uint32_t from, std::uint32_t to, double centre) {
    for (std::uint32_t k = from; k <= to; ++k) {
      const double angle = 0.5 * std::numbers::pi * k / quarter;
      const bool pole = k == 0 || k == 2 * quarter;
      rings.push_back({pole ? 0.0 : r * std::sin(angle), centre - r * std::cos(angle)});
    }
  };
  arc(0, quarter, -h);
  arc(h > 0.0 ? quarter : quarter + 1, 2 * quarter, h);
  return rings;
}

}  // namespace

TriangleSurface tessellate(const Sphere& sphere, const Fineness& fineness) {
  return revolve(rounded_profile(sphere.radius, 0.0, fineness.segments), fineness.segments);
}

TriangleSurface tessellate(const Capsule& capsule, const Fineness& fineness) {
  return revolve(rounded_profile(capsule.radius, capsule.half_length(), fineness.segments), fineness.segments);
}

TriangleSurface tessellate(const Cylinder& cylinder, const Fineness& fineness) {
  const double r = cylinder.radius, h = cylinder.half_length();
  return revolve({{0.0, -h}, {r, -h}, {r, h}, {0.0, h}}, fineness.segments);
}

TriangleSurface tessellate(const Ellipsoid& ellipsoid, const Fineness& fineness) {
  TriangleSurface s = tessellate(Sphere{1.0}, fineness);
  for (Vec3& v : s.vertices) v = v.cwiseProduct(ellipsoid.semi_axes);
  return s;
}

TriangleSurface tessellate(const Superquadric& superquadric, const Fineness& fineness) {
  TriangleSurface s = tessellate(Sphere{1.0}, fineness);
  // powers of the sines and cosines of both angles (Barr 1981): points gather at the edges, where the normal turns
  const auto power = [](double base, int exponent) {
    constexpr double rounding = 1e-12;
    const double size = std::abs(base);
    return size < rounding ? 0.0 : std::copysign(std::pow(size, 2.0 / exponent), base);
  };
  for (Vec3& v : s.vertices) {
    const double ring = std::hypot(v.x(), v.y()), out = power(ring, superquadric.along);
    if (ring > 0.0) v.head<2>() /= ring;
    v = Vec3(out * power(v.x(), superquadric.across), out * power(v.y(), superquadric.across),
             power(v.z(), superquadric.along))
            .cwiseProduct(superquadric.semi_axes);
  }
  return s;
}

TriangleSurface tessellate(const ConvexHull& hull, const Fineness&) {
  TriangleSurface s{hull.vertices, {}};
  for (std::size_t f = 0; f + 1 < hull.face_begin.size(); ++f)
    for (std::uint32_t k = hull.face_begin[f] + 2; k < hull.face_begin[f + 1]; ++k)
      s.triangles.push_back({hull.face_vertices[hull.face_begin[f]], hull.face_vertices[k - 1], hull.face_vertices[k]});
  return s;
}

TriangleSurface tessellate(const Box& box, const Fineness& fineness) { return tessellate(box.hull, fineness); }

TriangleSurface tessellate(const Clump& clump, const Fineness& fineness) {
  TriangleSurface all;
  for (const PlacedBall& ball : clump.parts) {
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    const TriangleSurface one = tessellate(Sphere{ball.radius}, fineness);
    for (const Vec3& v : one.vertices) all.vertices.push_back(ball.centre + v);
    for (const Triangle& t : one.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

TriangleSurface tessellate(const SolidParts& solid, const Fineness&) { return solid.surface; }

TriangleSurface tessellate(const TriangleMesh& mesh, const Fineness&) { return {mesh.vertices, mesh.triangles}; }

TriangleSurface tessellate(const HollowWall& wall, const Fineness& fineness) {
  const std::uint32_t n = fineness.segments;
  TriangleSurface s;
  const auto ring = [&](bool at_end) {
    const double r = wall.radius_of_end(at_end);
    for (std::uint32_t k = 0; k < n; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / n;
      s.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), wall.z_of_end(at_end));
    }
  };
  ring(false);
  ring(true);
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    if (wall.start_radius > 0.0) s.triangles.push_back({k, next, n + next});
    if (wall.end_radius > 0.0) s.triangles.push_back({k, n + next, n + k});
  }
  for (const bool at_end : {false, true}) {
    if (!wall.closed || !(wall.radius_of_end(at_end) > 0.0)) continue;
    const auto middle = static_cast<std::uint32_t>(s.vertices.size()), first = at_end ? n : 0;
    s.vertices.emplace_back(0.0, 0.0, wall.z_of_end(at_end));
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = first + k, b = first + (k + 1) % n;
      s.triangles.push_back(at_end ? Triangle{middle, a, b} : Triangle{middle, b, a});
    }
  }
  return s;
}

TriangleSurface tessellate(const HalfSpace& half_space, const Fineness& fineness) {
  const ContactFrame frame = contact_frame(half_space.normal);
  const double h = 0.5 * fineness.plane_size;
  const Vec3 u = h * frame.tangent1, v = h * frame.tangent2;
  return {{-u - v, u - v, u + v, v - u}, {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace epafi
