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

/// Frames, column by column.
struct PackedChunk {
  std::vector<double> scales;  ///< units of the numbers: origin (3), step, force, residual, then of each moving field
  std::vector<std::string> columns;  ///< deflated, as they were asked for
};

/// A chunk as the page reads it: for each column its number of bytes (4), then scales, then columns. All columns, or
/// those at these indices, which must include all moving fields.
[[nodiscard]] std::string bytes_of(const PackedChunk& chunk);
[[nodiscard]] std::string bytes_of(const PackedChunk& chunk, const std::vector<std::size_t>& columns);

class Packer {
 public:
  /// stride: every so many frames, and the last one.
  Packer(const ViewSource& source, const Overview& overview, std::size_t stride = 1);

  std::size_t frames() const { return shown_.size(); }
  std::size_t chunks() const { return (shown_.size() + chunk_frames - 1) / chunk_frames; }
  /// JSON: everything but bodies, meshes and frames. columns: what the chunks hold.
  std::string manifest(const std::vector<std::string>& columns, const std::vector<std::string>& notes,
                       const std::string& identity = {}) const;
  /// Bodies and meshes, deflated.
  std::string bodies() const;
  /// columns: of columns(), and "strong": contacts with a tenth of the strongest force.
  PackedChunk chunk(std::size_t k, const std::vector<std::string>& columns) const;
  /// All that a chunk can hold.
  const std::vector<std::string>& columns() const { return columns_; }
  double least_force() const;  ///< of "strong" [N]

 private:
  double step() const;
  bool is_moving(const std::string& column) const;
  const ViewSource& source_;
  const Overview& overview_;
  std::vector<ViewField> fields_;
  std::vector<std::size_t> shown_;
  std::vector<std::string> columns_;
};

}  // namespace epafi
