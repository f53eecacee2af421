/// @file vtp_writer.h  Points, lines and polygons with data arrays as VTK XML PolyData (.vtp, appended raw). Without
/// the VTK library; read by VTK 9.1 and ParaView 5.11 (VTK File Formats, Kitware 2005).
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "engine/state/large_column.h"

namespace epafi {

/// Values of an array; several threads write them, each the pages it then has near.
template <class T>
using VtpColumn = UnwrittenColumn<T>;

/// Named tuples, `components` values each.
struct VtpArray {
  using Values = std::variant<VtpColumn<float>, VtpColumn<double>, VtpColumn<std::int32_t>, VtpColumn<std::uint32_t>,
                              VtpColumn<std::uint16_t>, VtpColumn<std::uint8_t>>;
  std::string name;
  int components = 1;
  Values values;
};

/// Cells as compressed rows: cell c has the points connectivity[offsets[c-1] .. offsets[c]), offsets[-1] = 0.
struct VtpCells {
  VtpColumn<std::int32_t> connectivity, offsets;
  std::size_t size() const { return offsets.size(); }
};

/// One PolyData piece. Cell data run over vertices, then lines, then polygons.
struct PolyData {
  double time = 0.0;        ///< [s]
  VtpColumn<float> points;  ///< x y z of each point [m]
  VtpCells vertices, lines, polygons;
  std::vector<VtpArray> point_data, cell_data;
  std::size_t point_count() const { return points.size() / 3; }
};

/// A compressed file (zlib level 1 in blocks) ready to be written: several threads encode it, and different files may
/// be written at once. Index arrays of meshes shrink to almost nothing.
class VtpFile {
 public:
  explicit VtpFile(const PolyData& data);
  /// Throws FileError.
  void write(const std::filesystem::path& path) const;

 private:
  std::string head_;                 ///< up to the raw data
  std::vector<std::string> arrays_;  ///< encoded
};

/// An uncompressed file (compression hardly shrinks positions and takes ten times as long) of rows with equal numbers
/// of points and cells. It is drawn a piece at a time, so a frame takes no memory (columns of 100 000 spheres take
/// 23 MB, and new pages half of the time): draw(k) returns rows [begins[k], begins[k + 1]); only the whole file may be
/// empty. Throws FileError.
void write_vtp_pieces(const std::filesystem::path& path, const std::vector<std::size_t>& begins,
                      const std::function<PolyData(std::size_t piece)>& draw);
/// The same by equal pieces: draw(begin, end) has rows [begin, end).
void write_vtp_rows(const std::filesystem::path& path, std::size_t rows,
                    const std::function<PolyData(std::size_t begin, std::size_t end)>& draw);

}  // namespace epafi
