/// @file mesh_sweep.h  Poses of one body on a surface of triangles against the solid that the surface encloses, a union
/// of convex parts: the deepest contact must be as deep as the way out of the deepest part, and every contact must be a
/// way out of some part. Depths are found without the code under test: of polyhedra by trying every axis, else by
/// climbing over the directions (pair_errors.h); searches only start them.
#pragma once
#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"
#include "tests/support/holed_plate.h"
#include "tests/support/pair_errors.h"
#include "tests/support/stepped_rocks.h"
#include "tests/support/united_contacts.h"

namespace epafi::support {

enum class RockKind { table, plate, steps, hull, holed };

struct SweptRock {
  struct Part {
    ConvexHull hull;
    Vec3 centre;
  };
  TriangleMesh mesh;
  Pose of_mesh;             ///< puts the mesh where the parts are
  double precision = 0.0;   ///< of its corners [m]
  std::vector<Part> parts;  ///< about the origin
  SteppedRock cells{};      ///< of plates and steps, their middle at the origin
  Vec3 half = Vec3::Ones();
  std::vector<Vec3> corners;  ///< where bodies are put, if not anywhere
};

/// Half of all rocks are as written: others in a frame of their own, up to 100 m away, and rounded to single precision.
/// Half of each look inwards.
inline SweptRock random_swept_rock(Random& random, RockKind kind) {
  SweptRock rock;
  TriangleSurface surface;
  if (kind == RockKind::hull) {
    const ConvexHull hull = random_hull(random, 6 + random.bits() % 20, Vec3::Constant(0.5));
    surface.vertices = hull.vertices;
    for (std::size_t f = 0; f + 1 < hull.face_begin.size(); ++f)
      for (std::uint32_t k = hull.face_begin[f] + 1; k + 1 < hull.face_begin[f + 1]; ++k)
        surface.triangles.push_back(
            {hull.face_vertices[hull.face_begin[f]], hull.face_vertices[k], hull.face_vertices[k + 1]});
    rock.parts.push_back({hull, Vec3::Zero()});
  } else if (kind == RockKind::table) {
    rock.half = testing::random_point(random, 0.1, 0.5);
    surface = table_surface(rock.half, 1 + static_cast<int>(random.bits() % 4), random);
    rock.parts.push_back({Box(rock.half).hull, Vec3::Zero()});
  } else if (kind == RockKind::holed) {
    rock.half = testing::random_point(random, 0.1, 0.5);
    HoledPlate plate = random_holed_plate(random, rock.half);
    surface = std::move(plate.surface);
    rock.corners = std::move(plate.corners);
    for (auto& [hull, centre] : plate.parts) rock.parts.push_back({std::move(hull), centre});
  } else {
    const int n = 2 + static_cast<int>(random.bits() % (kind == RockKind::plate ? 3 : 2));
    rock.cells = random_rock(random, {n, n, kind == RockKind::plate ? 1 : 2}, 0.75);
    rock.half = 0.5 * rock.cells.size();
    surface = testing::moved(surface_of(rock.cells, random), testing::upright, -rock.half);
    for (const RockPart& p : parts_of(rock.cells)) rock.parts.push_back({p.box.hull, p.centre - rock.half});
  }
  if (random.bits() & 1u) {
    const Pose frame{std::pow(10.0, random.uniform(-1, 2)) * testing::random_direction(random),
                     testing::random_turn(random)};
    double most = 0.0;
    for (Vec3& v : surface.vertices) {
      v = frame.to_world(v).cast<float>().cast<double>();
      most = std::max(most, v.cwiseAbs().maxCoeff());
    }
    rock.precision = std::ldexp(most, -24);
    rock.of_mesh.orientation = frame.orientation.conjugate();
    rock.of_mesh.position = -(rock.of_mesh.orientation * frame.position);
  }
  if (random.bits() & 1u)
    for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  rock.mesh = TriangleMesh::from_surface(std::move(surface), rock.precision);
  return rock;
}

template <class S, class F>
void each_piece(const S& body, const Pose& pose, const F& f) {
  if constexpr (Compound<S>)
    for (std::size_t k = 0; k < body.part_count(); ++k) f(body.part(k), body.part_pose(k, pose));
  else
    f(body, pose);
}

struct WayOfPart {
  double gap;
  Vec3 normal;  ///< from the body to the part
};

template <class S>
WayOfPart searched_way(const S& body, const Pose& pose, const SweptRock::Part& part) {
  const Pose at{part.centre, testing::upright};
  const MinkowskiDifference difference(ConvexRef::to(body), ConvexRef::to(part.hull), pose, at);
  const GjkResult g = gjk(difference);
  if (g.status != GjkResult::Status::overlapping) return {g.lower - body.rounding(), pose.orientation * g.normal};
  const Penetration p = epa(difference);
  return {-p.upper - body.rounding(), pose.orientation * p.normal};
}

/// The largest separation over all directions.
template <class S>
double exact_gap(const S& body, const Pose& pose, const SweptRock::Part& part, Random& random) {
  const Pose at{part.centre, testing::upright};
  if constexpr (std::is_same_v<S, Box>)
    return brute_force_distance(body.hull, pose, part.hull, at);
  else if constexpr (PolyhedralShape<S>)
    return brute_force_distance(body, pose, part.hull, at);
  else {
    Vec3 start = searched_way(body, pose, part).normal;
    double best = climb(body, pose, part.hull, at, start, random);
    for (const Vec3& face : part.hull.face_normals) {
      Vec3 n = -face;
      if (separation_along(body, pose, part.hull, at, n) > best - 0.02 * body.bounding_radius())
        best = std::max(best, climb(body, pose, part.hull, at, n, random));
    }
    return best;
  }
}

/// What a sweep found, and where it went wrong.
struct SweepTally {
  long poses = 0, wrong = 0, contacts = 0, missed = 0, too_deep = 0, off = 0, invented = 0, crowded = 0, walls = 0,
       missed_walls = 0;
  double worst = 0.0;  ///< of the gap, over the size or the precision of the rock, whichever is more
  long faults() const { return missed + too_deep + off + invented + crowded + missed_walls; }
};

template <class S>
class MeshSweep {
 public:
  MeshSweep(RockKind kind, Random& random) : kind_(kind), random_(random) {}

  /// One pose. False: it could not be placed.
  bool take(const S& body, SweepTally& tally) {
    const SweptRock rock = random_swept_rock(random_, kind_);
    const double size = body.bounding_radius();
    const Aabb box = body.bounding_box(Pose{});
    const double most = std::min(0.01 * size, 0.1 * (box.max - box.min).minCoeff());
    Pose pose;
    if (!place(body, rock, most * std::pow(10.0, random_.uniform(-5, 0)), pose)) return false;
    tolerance_ = 1e-6 * size + 10.0 * rock.precision;
    const long before = tally.faults();
    judge(body, pose, rock, contacts_of(body, pose, rock, 1e-3 * size), tally);
    tally.wrong += tally.faults() > before;
    return true;
  }

 private:
  static constexpr double leaning = 0.03;  ///< [rad]

  /// Laid flat or thrown; then moved until the deepest part is as deep as asked.
  bool place(const S& body, const SweptRock& rock, double depth, Pose& pose) {
    pose.orientation = testing::random_turn(random_);
    if (random_.bits() & 1u) {
      const double tilt = random_.bits() % 5 == 0 ? 0.0 : std::pow(10.0, random_.uniform(-8, -1.5));
      const Quat down(Eigen::AngleAxisd(0.5 * testing::pi * static_cast<double>(random_.bits() % 4),
                                        Vec3::Unit(random_.bits() % 3)));
      const Quat yaw(Eigen::AngleAxisd(random_.uniform(0, 2 * testing::pi), Vec3::UnitZ()));
      pose.orientation = Quat(Eigen::AngleAxisd(tilt, testing::random_direction(random_))) * yaw * down;
    }
    const double size = body.bounding_radius();
    const Vec3 inside = 1.1 * rock.half.cwiseProduct(testing::random_point(random_));
    pose.position = inside + size * random_.uniform(0.2, 1.2) * testing::random_direction(random_);
    if (!rock.corners.empty())
      pose.position = rock.corners[random_.bits() % rock.corners.size()] - pose.orientation * somewhere_on(body);
    for (int step = 0; step < 30; ++step) {
      const WayOfPart now = deepest_way(body, pose, rock);
      if (std::abs(now.gap + depth) < 1e-9 * size) return is_outside(body, pose, rock);
      pose.position += (now.gap + depth) * now.normal;
    }
    return false;
  }
  /// A point of an edge or side, or near the body.
  Vec3 somewhere_on(const S& body) {
    const Vec3 d = testing::random_direction(random_), e = d + 0.3 * testing::random_direction(random_);
    if constexpr (Compound<S>)
      return body.bounding_radius() * random_.uniform(0.2, 1.0) * d;
    else
      return body.support(d) + body.rounding() * d + random_.uniform() * (body.support(e) - body.support(d));
  }
  static WayOfPart deepest_way(const S& body, const Pose& pose, const SweptRock& rock) {
    WayOfPart least{infinity, Vec3::Zero()};
    each_piece(body, pose, [&](const auto& piece, const Pose& at) {
      for (const auto& part : rock.parts)
        if (const WayOfPart w = searched_way(piece, at, part); w.gap < least.gap) least = w;
    });
    return least;
  }
  /// Its own centre, and those of its pieces: bodies are pushed to the side on which they are.
  static bool is_outside(const S& body, const Pose& pose, const SweptRock& rock) {
    bool outside = true;
    each_piece(body, pose, [&](const auto&, const Pose& at) {
      for (const auto& part : rock.parts) {
        bool inside = true;
        for (std::size_t f = 0; f < part.hull.face_normals.size(); ++f)
          inside = inside && part.hull.face_normals[f].dot(at.position - part.centre) < part.hull.face_offsets[f];
        outside = outside && !inside;
      }
    });
    return outside;
  }
  /// In a frame of its own.
  ContactSet contacts_of(const S& body, const Pose& pose, const SweptRock& rock, double reach) {
    frame_ = {testing::random_point(random_), testing::random_turn(random_)};
    ShapeStore shapes;
    World world(Columns{.rotation = true, .force = false});
    const auto add = [&](ShapeRef shape, const Pose& at, double mass) {
      Body b;
      b.shape = shape.packed;
      b.position = frame_.to_world(at.position);
      b.orientation = frame_.orientation * at.orientation;
      b.mass = mass;
      b.inertia = mass * Vec3::Ones();
      world.add(b);
    };
    add(shapes.add(body), pose, 1.0);
    add(shapes.add(rock.mesh), rock.of_mesh, 0.0);
    PairList list;
    list.pairs.push_back({0, 1});
    ContactSet out = testing::united_contacts(world, shapes, list, reach);
    for (std::size_t i = 0; i < out.size(); ++i) {
      out.normal[i] = frame_.orientation.conjugate() * out.normal[i];
      out.arm[i] = frame_.orientation.conjugate() * out.arm[i];
    }
    return out;
  }

  void judge(const S& body, const Pose& pose, const SweptRock& rock, const ContactSet& found, SweepTally& tally) {
    const double size = body.bounding_radius();
    double exact = infinity;
    std::vector<WayOfPart> ways;
    each_piece(body, pose, [&](const auto& piece, const Pose& at) {
      for (const auto& part : rock.parts) {
        ways.push_back(searched_way(piece, at, part));
        if (ways.back().gap < 0.1 * size) ways.back().gap = exact_gap(piece, at, part, random_);
        exact = std::min(exact, ways.back().gap);
      }
    });
    ++tally.poses;
    tally.contacts += static_cast<long>(found.size());
    const double gap = found.size() == 0 ? infinity : *std::min_element(found.gap.begin(), found.gap.end());
    tally.missed += gap == infinity;
    tally.too_deep += gap < exact - tolerance_;
    tally.off += std::abs(gap - exact) > tolerance_;
    if (gap < infinity) tally.worst = std::max(tally.worst, std::abs(gap - exact) / std::max(size, rock.precision));
    judge_normals(body, pose, rock, found, ways, tally);
    if (!rock.cells.filled.empty()) judge_walls(body, pose, rock, found, ways, tally);
  }

  /// Every normal is a way out of a part, as far as the contacts with it say, and has at most four of them. Where a
  /// face has notches its normal may stand for those that lean a little, if its contacts are no deeper.
  void judge_normals(const S& body, const Pose& pose, const SweptRock& rock, const ContactSet& found,
                     const std::vector<WayOfPart>& ways, SweepTally& tally) {
    std::vector<bool> seen(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (seen[i]) continue;
      double least = infinity;
      std::size_t count = 0;
      for (std::size_t k = i; k < found.size(); ++k) {
        if (!((found.normal[k] - found.normal[i]).norm() < 1e-6)) continue;
        seen[k] = true;
        ++count;
        least = std::min(least, found.gap[k]);
      }
      std::size_t number = 0;
      long carried = 0;
      each_piece(body, pose, [&](const auto& piece, const Pose& at) {
        for (const auto& part : rock.parts) {
          const double along =
              separation_along(piece, at, part.hull, Pose{part.centre, testing::upright}, found.normal[i]);
          const WayOfPart& way = ways[number++];
          const bool leans = (way.normal - found.normal[i]).norm() < leaning && along <= least;
          carried += (std::abs(along - least) <= tolerance_ || leans) && way.gap <= least + tolerance_;
        }
      });
      if constexpr (std::is_same_v<S, Capsule>) carried += is_of_end(body, pose, rock, found.normal[i], least);
      tally.invented += least < 0.0 && carried == 0;
    }
  }

  /// The ends of a capsule are balls that touch by themselves.
  bool is_of_end(const Capsule& body, const Pose& pose, const SweptRock& rock, const Vec3& normal, double gap) const {
    for (const double side : {-1.0, 1.0})
      for (const auto& part : rock.parts) {
        const Pose end{pose.to_world(Vec3(0, 0, side * body.half_length())), testing::upright};
        const double along =
            separation_along(Sphere{body.radius}, end, part.hull, Pose{part.centre, testing::upright}, normal);
        if (std::abs(along - gap) <= tolerance_) return true;
      }
    return false;
  }

  /// A part whose face is bare where the body's tip comes through it holds the body by that face. All parts of a body
  /// rest on four points of one normal: a deeper one may hold for this one.
  void judge_walls(const S& body, const Pose& pose, const SweptRock& rock, const ContactSet& found,
                   const std::vector<WayOfPart>& ways, SweepTally& tally) {
    const double size = body.bounding_radius();
    std::size_t number = 0;
    each_piece(body, pose, [&](const auto& piece, const Pose& at) {
      for (const auto& part : rock.parts) {
        const double gap = ways[number++].gap;
        if (gap > -1e-5 * size - 2.0 * tolerance_) continue;
        for (const Vec3& face : part.hull.face_normals) {
          const double along = separation_along(piece, at, part.hull, Pose{part.centre, testing::upright}, Vec3(-face));
          if (std::abs(along - gap) > 1e-12) continue;
          const Vec3 tip = at.to_world(piece.support(at.orientation.conjugate() * -face)) - piece.rounding() * face;
          if (!is_bare(rock, tip, face, -gap)) continue;
          ++tally.walls;
          bool held = false;
          for (std::size_t i = 0; i < found.size(); ++i)
            held = held || ((found.normal[i] + face).norm() < 1e-3 && found.gap[i] < gap + tolerance_ &&
                            (Compound<S> || found.gap[i] > gap - tolerance_));
          tally.missed_walls += !held;
        }
      }
    });
  }
  /// The rock ends `depth` beyond x along the normal, there and a little beside.
  static bool is_bare(const SweptRock& rock, const Vec3& x, const Vec3& normal, double depth) {
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    for (int k = 0; k < 8; ++k) {
      const double angle = 0.25 * testing::pi * k, beside = 0.01 + 2.0 * depth;
      const Vec3 at = x + rock.half + beside * (std::cos(angle) * u + std::sin(angle) * v);
      if (!rock.cells.is_inside(at - depth * normal)) return false;
      for (const double out : {2.0 * depth + 1e-6, 0.02})
        if (rock.cells.is_inside(at + out * normal)) return false;
    }
    return true;
  }

  RockKind kind_;
  Random& random_;
  double tolerance_ = 0.0;
  Pose frame_;
};

}  // namespace epafi::support
