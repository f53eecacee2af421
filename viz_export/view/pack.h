/// @file pack.h  A run made small for the page. Positions are whole steps of 1e-5 of the picture's box, orientations 32
/// bits, fields 16 bits of their largest value; each frame is stored as its difference from the one before, byte by
/// byte (planes.h), and deflated. Frames come in chunks that are read each by itself.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "viz_export/view/mesh.h"
#include "viz_export/view/overview.h"

namespace epafi {

inline constexpr std::size_t chunk_frames = 8;

struct PackPlan {
  std::size_t stride = 1;   ///< every so many frames, and the last one
  bool headings = true;     ///< directions of velocities, for arrows
  float least_force = 0.0;  ///< contacts below it are left out [N]; negative: all are
};

class Packer {
 public:
  Packer(const ViewSource& source, const Overview& overview, const PackPlan& plan);

  std::size_t frames() const { return shown_.size(); }
  std::size_t chunks() const { return (shown_.size() + chunk_frames - 1) / chunk_frames; }
  /// JSON: everything but bodies, meshes and frames.
  std::string manifest(const std::vector<std::string>& notes) const;
  /// Bodies and meshes, deflated.
  std::string bodies() const;
  /// For each column a number of bytes (4), then the deflated columns. `sizes`: bytes of each column.
  std::string chunk(std::size_t k, std::vector<std::size_t>* sizes = nullptr) const;
  /// Names of the columns of a chunk, in their order.
  const std::vector<std::string>& columns() const { return columns_; }

 private:
  double step() const;
  const ViewSource& source_;
  const Overview& overview_;
  PackPlan plan_;
  std::vector<ViewField> fields_;
  std::vector<std::size_t> shown_;
  std::vector<std::string> columns_;
  bool has_orientation_ = false;
};

}  // namespace epafi
