#include "detection/shapes/hull_lanes.h"

#include <algorithm>
#include <cstring>

#include "engine/lanes/targets.h"

namespace epafi {
namespace {

EPAFI_LANES Lanes load(const double* p) {
  Lanes x;
  std::memcpy(&x, p, sizeof x);
  return x;
}
EPAFI_LANES Lanes3 all(const Vec3& v) { return {lanes(v.x()), lanes(v.y()), lanes(v.z())}; }
EPAFI_LANES Lanes gather(const double* from, const std::array<std::uint32_t, 4>& at) {
  return Lanes{from[at[0]], from[at[1]], from[at[2]], from[at[3]]};
}

/// Appends the numbers first + lane of the lanes that are set.
EPAFI_LANES std::size_t append(LaneMask set, std::size_t first, std::uint32_t* out, std::size_t count) {
  for (std::size_t k = 0; k < lane_count; ++k) {  // no branch: the next one overwrites what is not kept
    out[count] = static_cast<std::uint32_t>(first + k);
    count += set[k] != 0;
  }
  return count;
}

/// The largest value met, lane by lane, and the first group that had it.
struct Largest {
  Lanes value;
  LaneMask group;
  EPAFI_LANES explicit Largest(Lanes first) : value(first), group(LaneMask{0, 0, 0, 0}) {}
  EPAFI_LANES void meet(Lanes x, std::size_t g) {
    const auto k = static_cast<long long>(g);
    const LaneMask larger = x > value;
    value = larger ? x : value;
    group = larger ? LaneMask{k, k, k, k} : group;
  }
  EPAFI_LANES std::uint32_t first_index() const {
    double best = value[0];
    long long index = lane_count * group[0];
    for (int k = 1; k < lane_count; ++k) {
      const long long i = lane_count * group[k] + k;
      const bool better = value[k] > best || (value[k] == best && i < index);
      best = better ? value[k] : best;
      index = better ? i : index;
    }
    return static_cast<std::uint32_t>(index);
  }
};

struct Farthest {
  EPAFI_LANES static std::uint32_t run(std::span<const VertexLanes> vertices, const Vec3& d) {
    const Lanes3 n = all(d);
    Largest largest(n.dot(vertices[0].at));
    for (std::size_t g = 1; g < vertices.size(); ++g) largest.meet(n.dot(vertices[g].at), g);
    return largest.first_index();
  }
};

struct Heights {
  EPAFI_LANES static std::uint32_t run(std::span<const FaceLanes> faces, const Vec3& x, double* out) {
    const Lanes3 at = all(x);
    Largest largest(lanes(-INFINITY));
    for (std::size_t g = 0; g < faces.size(); ++g) {
      const Lanes h = faces[g].normal.dot(at) - faces[g].offset;
      std::memcpy(out + lane_count * g, &h, sizeof h);
      largest.meet(h, g);
    }
    return largest.first_index();
  }
};

/// Counts the faces that are not below and takes off the own ones among them: a mask that is asked group by group costs
/// as much as the heights.
struct AllBelow {
  EPAFI_LANES static bool run(std::span<const FaceLanes> faces, std::span<const Vec3> points, double least,
                              std::span<const std::uint32_t> own) {
    LaneMask high{0, 0, 0, 0};
    for (const FaceLanes& f : faces) {
      Lanes highest = lanes(-INFINITY);
      for (const Vec3& x : points) highest = max(highest, f.normal.dot(all(x)));
      high -= highest - f.offset >= lanes(least);
    }
    long long others = high[0] + high[1] + high[2] + high[3];
    for (const std::uint32_t k : own) {
      const FaceLanes& f = faces[k / lane_count];
      const std::size_t lane = k % lane_count;
      double highest = -INFINITY;
      for (const Vec3& x : points)
        highest = max(highest, f.normal.x[lane] * x.x() + f.normal.y[lane] * x.y() + f.normal.z[lane] * x.z());
      others -= highest - f.offset[lane] >= least;
    }
    return others == 0;
  }
};

struct HighFaces {
  EPAFI_LANES static std::size_t run(const FaceHeights& of, std::size_t faces, double point, double centre,
                                     std::uint32_t* out) {
    std::size_t count = 0;
    for (std::size_t f = 0; f < faces; f += lane_count) {
      const LaneMask high = (load(of.point + f) >= lanes(point)) & (load(of.centre + f) >= lanes(centre));
      if (any(high)) count = append(high, f, out, count);
    }
    return count;
  }
};

struct PromisingEdges {
  EPAFI_LANES static std::size_t run(std::span<const EdgeLanes> edges, const FaceHeights& of, double best, double inner,
                                     double slack, std::uint32_t* out) {
    std::size_t count = 0;
    const double needed = best + inner;
    for (std::size_t g = 0; g < edges.size(); ++g) {
      const EdgeLanes& e = edges[g];
      LaneMask may = max(gather(of.point, e.left), gather(of.point, e.right)) > lanes(best);
      if (best >= 0.0) may = LaneMask{-1, -1, -1, -1};
      if (!any(may)) continue;
      if (best < 0.0)  // one vertex deepest below both faces: over the arc no direction is better than these two
        for (std::size_t k = 0; k < lane_count; ++k) {
          const std::uint32_t l = of.deepest[e.left[k]], r = of.deepest[e.right[k]];
          may[k] = l == r && l != FaceHeights::unknown ? 0 : may[k];
        }
      const Lanes l = gather(of.centre, e.left), r = gather(of.centre, e.right);
      if (needed > 0.0) {  // the centre must be as high at an end of the arc, or between its ends
        const Lanes room = lanes(slack);
        const LaneMask ends = max(l, r) >= lanes(needed) - room;
        const LaneMask between = (l >= e.cosine * r - room) & (r >= e.cosine * l - room);
        may = may & (ends | between);
      }
      count = append(may, lane_count * g, out, count);
    }
    return count;
  }
};

struct CrossingArcs {
  EPAFI_LANES static std::size_t run(std::span<const ArcLanes> arcs, const Arc& other, double least,
                                     std::uint32_t* out) {
    const Lanes3 from = all(other.from), along = all(other.along), left = all(other.left), right = all(other.right);
    // least |n| <= n.w without the root: both sides squared, with room for the rounding of the squares
    const Lanes square_of_least = lanes(least * least * (least < 0.0 ? 1.0 + 1e-12 : 1.0 - 1e-12));
    const Lanes zero = lanes(0.0);
    std::size_t count = 0;
    for (std::size_t g = 0; g < arcs.size(); ++g) {
      const ArcLanes& a = arcs[g];
      const Lanes left_b = a.along.dot(left), right_b = a.along.dot(right);
      const Lanes left_a = along.dot(a.left), right_a = along.dot(a.right);
      LaneMask cross = (left_b * right_b < zero) & (left_a * right_a < zero) & (left_b * right_a > zero);
      if (!any(cross)) continue;
      const Lanes3 n = a.along.cross(along), w = from - a.from;
      const Lanes outward = n.dot(a.left + a.right), height = n.dot(w);
      const Lanes u = outward < zero ? -height : height, square = u * u, bound = square_of_least * n.dot(n);
      const LaneMask above = least < 0.0 ? (u >= zero) | (square <= bound) : (u > zero) & (square >= bound);
      cross = cross & above;
      if (any(cross)) count = append(cross, lane_count * g, out, count);
    }
    return count;
  }
};

// Each kernel is inlined into the function that calls it here and follows that function's target.
struct Baseline {
  static constexpr const char* name = "sse2";
  template <class Kernel, class Result, class... Arguments>
  static Result call(Arguments... arguments) {
    return Kernel::run(arguments...);
  }
};
#if defined(__x86_64__)
struct Avx2 {
  static constexpr const char* name = "avx2";
  template <class Kernel, class Result, class... Arguments>
  [[gnu::target("avx2")]] static Result call(Arguments... arguments) {
    return Kernel::run(arguments...);
  }
};
struct Avx512 {
  static constexpr const char* name = "avx512";
  template <class Kernel, class Result, class... Arguments>
  [[gnu::target("avx512f,avx512vl,avx512dq")]] static Result call(Arguments... arguments) {
    return Kernel::run(arguments...);
  }
};
#endif

template <class Built>
HullKernels kernels() {
  return {Built::name,
          &Built::template call<Farthest>,
          &Built::template call<Heights>,
          &Built::template call<AllBelow>,
          &Built::template call<HighFaces>,
          &Built::template call<PromisingEdges>,
          &Built::template call<CrossingArcs>};
}

std::vector<HullKernels> find_kernels() {
  std::vector<HullKernels> out{kernels<Baseline>()};
#if defined(__x86_64__)
  if (target() >= Target::avx2) out.push_back(kernels<Avx2>());
  if (target() >= Target::avx512) out.push_back(kernels<Avx512>());
#endif
  return out;
}

void put(Lanes3& v, std::size_t k, const Vec3& x) {
  v.x[k] = x.x();
  v.y[k] = x.y();
  v.z[k] = x.z();
}

}  // namespace

void ArcLanes::set(std::size_t k, const Arc& arc) {
  put(from, k, arc.from);
  put(along, k, arc.along);
  put(left, k, arc.left);
  put(right, k, arc.right);
}

VertexLanes vertex_lanes(std::span<const Vec3> vertices, std::size_t first) {
  VertexLanes out{};
  for (std::size_t k = 0; k < lane_count; ++k) put(out.at, k, vertices[std::min(first + k, vertices.size() - 1)]);
  return out;
}

FaceLanes face_lanes(std::span<const Vec3> normals, std::span<const double> offsets, std::size_t first) {
  FaceLanes out{};
  out.offset = lanes(INFINITY);
  for (std::size_t k = 0; k < lane_count && first + k < normals.size(); ++k) {
    put(out.normal, k, normals[first + k]);
    out.offset[k] = offsets[first + k];
  }
  return out;
}

EdgeLanes edge_lanes(std::span<const HullEdge> edges, std::span<const Vec3> normals, std::size_t first) {
  EdgeLanes out{};
  for (std::size_t k = 0; k < lane_count; ++k) {
    const HullEdge& e = edges[std::min(first + k, edges.size() - 1)];
    out.left[k] = e.left;
    out.right[k] = e.right;
    out.cosine[k] = normals[e.left].dot(normals[e.right]);
  }
  return out;
}

std::span<const HullKernels> all_hull_kernels() {
  static const std::vector<HullKernels> all = find_kernels();
  return all;
}

const HullKernels& hull_kernels() {
  static const HullKernels widest = all_hull_kernels().back();
  return widest;
}

}  // namespace epafi
