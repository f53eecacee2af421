/// @file pair_query.h  Arguments of every pair function: collide(shape_a, shape_b, query, sink).
#pragma once
#include <memory>
#include <vector>

#include "detection/narrow/polyhedra/pair_memory.h"
#include "engine/state/contacts.h"

namespace epafi {

/// Memory of a pair from its last step. Results have the same bits without it, so it is not state.
struct PairCache {
  Vec3 axis = Vec3::Zero();  ///< a direction that separates, from A to B, world axes; zero: unknown
  /// Memory of two polyhedra that have touched, or whose axis no longer separates; null for most pairs.
  std::unique_ptr<PairMemory> polyhedra;

  PairMemory& made() {
    if (!polyhedra) polyhedra = std::make_unique<PairMemory>();
    return *polyhedra;
  }
};

/// Memory of pairs of convex parts of two bodies, for the pairs of the last queries, in the order of the parts (about
/// twelve of a hundred pairs for ten parts each). Like PairCache it does not affect results.
class PartMemory {
  struct Entry {
    std::uint32_t parts;
    PairCache cache;
  };

 public:
  static constexpr std::size_t bytes_per_pair = sizeof(Entry);  ///< of parts

  /// Starts a pass; between begin() and end() call of() in ascending order.
  void begin() { at_ = asked_ = 0; }
  PairCache& of(std::uint32_t parts) {
    while (at_ < entries_.size() && entries_[at_].parts < parts) ++at_;
    if (at_ == entries_.size() || entries_[at_].parts != parts)
      entries_.insert(entries_.begin() + static_cast<std::ptrdiff_t>(at_), {parts, {}});
    ++asked_;
    return entries_[at_].cache;
  }
  /// Discards the memory if most of it belongs to parts that were not queried.
  void end() {
    if (entries_.size() > 2 * asked_ + 8) entries_.clear();
  }
  std::size_t size() const { return entries_.size(); }

 private:
  std::vector<Entry> entries_;
  std::size_t at_ = 0, asked_ = 0;
};

struct RestingPatch;

/// One pair at one instant.
struct PairQuery {
  Pose a, b;
  double reach = 0.0;      ///< find contacts with gap < reach [m]; 0: overlapping ones only
  bool curvature = false;  ///< compute effective_radius
  PairCache* cache = nullptr;
  bool area = false;                                 ///< for polyhedra: cells of the overlap volume instead of points
  std::unique_ptr<RestingPatch>* resting = nullptr;  ///< state of two polyhedra that may keep their points
  PartMemory* parts = nullptr;                       ///< for bodies with convex parts
  bool wall_a = false, wall_b = false;               ///< fixed or driven: its flat faces have infinite radius

  /// The same query for parts at poses p and r, without memory.
  PairQuery of_parts(const Pose& p, const Pose& r) const {
    PairQuery q{p, r, reach, curvature, nullptr, area};
    q.wall_a = wall_a;
    q.wall_b = wall_b;
    return q;
  }
  PairQuery exchanged() const {
    PairQuery q = of_parts(b, a);
    std::swap(q.wall_a, q.wall_b);
    return q;
  }
};

/// Collects the contact points of one pair at a time into a block's contact set, in the order of their features.
class ContactSink {
 public:
  explicit ContactSink(ContactSet& out) : out_(out) {}
  /// Begins a pair; the next points belong to it. image: image code of the contact's key, in a periodic cell.
  void begin(Slot a, Slot b, std::uint32_t image = 0) {
    a_ = a;
    b_ = b;
    first_ = out_.size();
    flipped_ = false;
    image_ = Feature{image} << 56;
    part_ = 0;
    depth_ = 0;
    offset_.setZero();
  }
  /// The next points belong to part k of a body; offset: of the part from A's centre if it is a part of A, else 0 [m].
  /// k is in bits 48 to 55 of the feature, the number of a part within a part in the eight bits below.
  void enter_part(std::size_t k, const Vec3& offset) {
    depth_ += 1;
    part_ |= Feature{k} << (56 - 8 * depth_);
    offset_ += offset;
  }
  void leave_part(const Vec3& offset) {
    part_ &= ~(Feature{0xff} << (56 - 8 * depth_));
    depth_ -= 1;
    offset_ -= offset;
  }
  /// The next points come from a function with exchanged bodies: normals change sign, arms are converted to A. centre:
  /// of the function's A relative to the pair's A [m].
  void flip(const Vec3& centre) {
    flipped_ = true;
    centre_ = centre;
  }
  void add(const ContactPoint& c) {
    if (!flipped_)
      out_.append(a_, b_, c);
    else
      out_.append(a_, b_, {c.gap, -c.normal, c.arm + centre_, c.effective_radius, c.feature, c.area});
    if (depth_ > 0) out_.arm.back() += offset_;
    out_.feature.back() |= image_ | part_;
  }
  /// Counts a pair whose certified interval did not close, for the narrow phase.
  void mark_degenerate() { ++degenerate_; }
  std::size_t degenerate() const { return degenerate_; }
  /// Ends the pair: sorts its points by feature, which is unique within a pair.
  void end() {
    if (out_.size() > first_ + 1) sort();
  }
  /// Number of points of the present pair so far.
  std::size_t count() const { return out_.size() - first_; }

 private:
  void sort() {  // insertion: at most a few points, mostly in order
    for (std::size_t i = first_ + 1; i < out_.size(); ++i) {
      for (std::size_t j = i; j > first_ && out_.feature[j] < out_.feature[j - 1]; --j) {
        std::swap(out_.feature[j], out_.feature[j - 1]);
        std::swap(out_.gap[j], out_.gap[j - 1]);
        std::swap(out_.normal[j], out_.normal[j - 1]);
        std::swap(out_.arm[j], out_.arm[j - 1]);
        if (out_.with_curvature) std::swap(out_.effective_radius[j], out_.effective_radius[j - 1]);
        if (out_.with_area) std::swap(out_.area[j], out_.area[j - 1]);
      }
    }
  }
  ContactSet& out_;
  Slot a_ = 0, b_ = 0;
  std::size_t first_ = 0, degenerate_ = 0;
  bool flipped_ = false;
  Feature image_ = 0, part_ = 0;
  int depth_ = 0;
  Vec3 centre_ = Vec3::Zero(), offset_ = Vec3::Zero();
};

/// Radius that stands for a shape's curvature in R* [m]: exact for spheres, infinite for planes, otherwise the shape's
/// choice.
template <class S>
double contact_radius(const S& s) {
  if constexpr (requires { s.contact_radius(); }) {
    return s.contact_radius();
  } else {
    return s.bounding_radius();
  }
}

/// R* = 1/(1/R_a + 1/R_b); infinity for a plane gives the other's radius. Two planes: infinity.
inline double effective_radius(double radius_a, double radius_b) { return 1.0 / (1.0 / radius_a + 1.0 / radius_b); }

}  // namespace epafi
