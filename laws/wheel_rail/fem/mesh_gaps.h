/// @file mesh_gaps.h  The block's surface against the other body's, each a mesh of triangles of its own: gaps by
/// closest-point projection through engine/railway/gap_operator.h, linearised where the nodes stand and evaluated again
/// where they have moved to (Wriggers 2006, chapters 4 and 6).
#pragma once
#include <memory>

#include "engine/railway/contact_region.h"
#include "laws/wheel_rail/fem/elastic_block.h"
#include "laws/wheel_rail/fem/surface_contact.h"

namespace epafi {

class MeshGaps {
 public:
  /// The other surface stands at -h(x, y) over the block's: h is taken from the source on a mesh six times finer.
  MeshGaps(const BlockMesh& mesh, const GapSource& source, const ContactRegion& region, GapMethod method);
  /// Contact to this target. W: inward displacement of the candidates per force on each [m/N].
  SurfaceContact solve(const Eigen::MatrixXd& W, const NormalTarget& target, Enforcement method, double penalty);
  /// Forces of the last solution on the candidate nodes, into the block [N].
  const Eigen::VectorXd& force() const { return force_; }
  /// The other surface is missing over some candidate.
  bool incomplete() const { return incomplete_; }

 private:
  SurfaceProblem linearise(const Eigen::MatrixXd& W, const Eigen::VectorXd& displacement, double approach);

  GapMethod method_;
  Eigen::Index candidates_;
  std::vector<Vec3> rest_;  ///< candidates, then nodes of the other surface [m]
  std::unique_ptr<GapOperator> gaps_;
  GapRows rows_;
  Eigen::MatrixXd transfer_;  ///< forces on the candidates into the block = transpose of this times the unknowns
  Eigen::VectorXd force_;
  bool incomplete_ = false;
};

}  // namespace epafi
