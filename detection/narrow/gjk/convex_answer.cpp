#include "detection/narrow/gjk/convex_answer.h"

#include <array>
#include <utility>

#include "detection/narrow/gjk/epa.h"

namespace epafi {
namespace {

constexpr double wide = 1e-12;  // of the size: an interval that is wider is named

/// witness_b still relative to A's position, both in A's axes.
ConvexAnswer by_supports(const PolyhedronPair& pair) {
  const MinkowskiDifference difference(core_of(pair.a), core_of(pair.b), pair.rotation, pair.offset);
  const GjkResult g = gjk(difference);
  if (g.status != GjkResult::Status::overlapping)
    return {"ok", g.lower, g.upper - g.lower, g.normal, g.witness_a, g.witness_b};
  const Penetration p = epa(difference, 1e-15);
  const char* status = p.status == Penetration::Status::flat ? "flat" : "ok";
  return {status, -p.upper, p.upper - p.lower, p.normal, p.witness_a, p.witness_b};
}

ConvexAnswer by_features(const PolyhedronPair& pair, PairMemory* memory) {
  const PolyhedronDistance d = polyhedron_distance(pair, infinity, memory);
  return {"ok", d.axis.gap, d.uncertainty, d.axis.normal, d.witness_a, d.witness_b};
}

ConvexAnswer by_axis(const PolyhedronPair& pair) {
  const PolyhedronDistance d = axis_distance(pair);
  return {d.axis.gap > 0.0 ? "lower-bound" : "ok", d.axis.gap, 0.0, d.axis.normal, d.witness_a, d.witness_b};
}

}  // namespace

const ConvexMethod* convex_method(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, ConvexMethod>, 3> methods{
      {{"auto", ConvexMethod::automatic}, {"sat", ConvexMethod::sat}, {"gjk-epa", ConvexMethod::gjk_epa}}};
  for (const auto& [known, method] : methods)
    if (known == name) return &method;
  return nullptr;
}

ConvexAnswer ask(ConvexMethod method, const PolyhedronView& a, const PolyhedronView& b, const Pose& pose_a,
                 const Pose& pose_b, PairMemory* memory) {
  const PolyhedronPair pair(a, b, pose_a, pose_b);
  ConvexAnswer answer = method == ConvexMethod::automatic ? by_features(pair, memory)
                        : method == ConvexMethod::sat     ? by_axis(pair)
                                                          : by_supports(pair);
  if (answer.uncertainty > wide * pair.size()) answer.status = "interval";
  const Mat3 to_world = pose_a.orientation.toRotationMatrix();
  answer.normal = to_world * answer.normal;
  answer.witness_b = to_world * (answer.witness_b - pair.offset);
  answer.witness_a = to_world * answer.witness_a;
  return answer;
}

}  // namespace epafi
