/// @file pack_columns.h  The columns of a chunk of frames: each takes frame after frame and becomes bytes.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "viz_export/view/fields.h"

namespace epafi {

/// Units of a chunk's whole numbers.
struct ChunkGrid {
  Vec3 origin;            ///< [m]
  double step;            ///< of positions [m]
  double strongest;       ///< force of a contact that has the largest number [N]
  double worst;           ///< residual of a contact that has the largest number; 0: there are none
  float least_force = 0;  ///< weaker contacts do not enter the column "strong" [N]
};

class ChunkColumn {
 public:
  virtual ~ChunkColumn() = default;
  virtual void add(const ViewFrame& frame, const FrameFields& fields) = 0;
  /// Bytes of all frames added; sets `scale`, the unit of the numbers, where the column has one of its own.
  virtual std::string raw(double& scale) = 0;
};

/// name: "id", "position", "rest", "largest", "heading", "contact", "strong" or a moving field.
[[nodiscard]] std::unique_ptr<ChunkColumn> make_column(const std::string& name, const ChunkGrid& grid);

}  // namespace epafi
