/// @file vtp_writer.h  Points, lines and polygons with data arrays as VTK XML PolyData (.vtp, appended raw), and the
/// .pvd list of frames. Without the VTK library; read by VTK 9.1 and ParaView 5.11 (VTK File Formats, Kitware 2005).
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/large_column.h"

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

/// Compressed: zlib level 1 in blocks. Index arrays of meshes shrink to almost nothing; positions hardly shrink and
/// cost ten times the time, so points of spheres are written plain.
enum class VtpEncoding { plain, compressed };

/// A piece of the raw data of a file: `head`, and behind it what stands in an array.
struct VtpPart {
  std::string head;
  std::span<const char> data;
};

/// A file ready to be written: several threads encode it, and different files may be written at once.
class VtpFile {
 public:
  VtpFile(PolyData data, VtpEncoding encoding);
  VtpFile(VtpFile&&) = default;
  VtpFile& operator=(VtpFile&&) = default;
  double time() const { return data_.time; }
  /// Throws FileError.
  void write(const std::filesystem::path& path) const;

 private:
  PolyData data_;
  std::string head_;            ///< up to the raw data
  std::vector<VtpPart> parts_;  ///< their data is in data_; compressed ones have none
};

/// Throws FileError.
void write_vtp(const std::filesystem::path& path, PolyData data, VtpEncoding encoding);

/// The list of frames that ParaView opens: which file shows at which time. Rewritten as a whole through a side file.
class PvdFile {
 public:
  explicit PvdFile(std::filesystem::path path) : path_(std::move(path)) {}
  /// Reads the list written by an earlier run and keeps the frames up to `time` [s].
  void keep_until(double time);
  /// `file` relative to the folder of the .pvd; part numbers the files of one time.
  void add(double time, int part, const std::string& file);
  void write() const;

  struct Entry {
    double time;
    int part;
    std::string file;
  };
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::filesystem::path path_;
  std::vector<Entry> entries_;
};

}  // namespace epafi
