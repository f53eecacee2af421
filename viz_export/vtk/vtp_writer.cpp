#include "viz_export/vtk/vtp_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/deflate.h"

namespace epafi {

namespace {

using Bytes = std::span<const char>;
constexpr std::size_t block_bytes = std::size_t{1} << 18;  // 32 KiB to 1 MiB compress equally well; larger forks less

template <class T>
Bytes bytes_of(const VtpColumn<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

constexpr const char* type_name(float) { return "Float32"; }
constexpr const char* type_name(double) { return "Float64"; }
constexpr const char* type_name(std::int32_t) { return "Int32"; }
constexpr const char* type_name(std::uint32_t) { return "UInt32"; }
constexpr const char* type_name(std::uint16_t) { return "UInt16"; }
constexpr const char* type_name(std::uint8_t) { return "UInt8"; }

void put_word(std::string& out, std::uint64_t word) { out.append(reinterpret_cast<const char*>(&word), sizeof word); }

/// Header [blocks, block size, size of a partial last block, compressed sizes...], then the zlib streams.
std::string compress_blocks(Bytes data) {
  const std::size_t blocks = (data.size() + block_bytes - 1) / block_bytes;
  std::vector<std::string> streams(blocks);
  parallel_blocks(data.size(), block_bytes, [&](std::size_t begin, std::size_t end, std::size_t b) {
    streams[b] = deflated(data.subspan(begin, end - begin), 1);
  });
  std::string out;
  put_word(out, blocks);
  put_word(out, block_bytes);
  put_word(out, data.size() % block_bytes);
  for (const std::string& s : streams) {
    if (s.empty()) throw FileError("zlib ran out of memory");
    put_word(out, s.size());
  }
  for (const std::string& s : streams) out += s;
  return out;
}

/// Arrays in the order of the file.
std::vector<Bytes> arrays_of(const PolyData& d) {
  std::vector<Bytes> out;
  for (const auto* arrays : {&d.point_data, &d.cell_data})
    for (const VtpArray& a : *arrays)
      std::visit([&](const auto& values) { out.push_back(bytes_of(values)); }, a.values);
  out.push_back(bytes_of(d.points));
  for (const VtpCells* cells : {&d.vertices, &d.lines, &d.polygons}) {
    out.push_back(bytes_of(cells->connectivity));
    out.push_back(bytes_of(cells->offsets));
  }
  return out;
}

/// Scales a number of rows by rows / of.
struct Multiple {
  std::size_t rows = 1, of = 1;
  std::size_t operator()(std::size_t n) const { return n / of * rows; }
};

/// Names each array by its offset in the appended section.
class ArrayTags {
 public:
  explicit ArrayTags(std::vector<std::size_t> offsets) : offsets_(std::move(offsets)) {}
  std::string array(const std::string& name, const char* type, int components) {
    return fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)",
                       type, name, components, offsets_[next_++]) +
           "\n";
  }
  std::string cells(const char* tag) {
    std::string out = fmt::format("<{}>\n", tag);
    out += array("connectivity", "Int32", 1);  // one behind the other: of a + b either may be called first
    out += array("offsets", "Int32", 1);
    return out + fmt::format("</{}>\n", tag);
  }
  std::string data(const char* tag, const std::vector<VtpArray>& arrays, [[maybe_unused]] std::size_t tuples) {
    std::string out = fmt::format("<{}>\n", tag);
    for (const VtpArray& a : arrays) {
      std::visit(
          [&](const auto& values) {
            EPAFI_REQUIRE(values.size() == tuples * static_cast<std::size_t>(a.components),
                          "one tuple per point or cell");
            using T = typename std::decay_t<decltype(values)>::value_type;
            out += array(a.name, type_name(T{}), a.components);
          },
          a.values);
    }
    return out + fmt::format("</{}>\n", tag);
  }

 private:
  std::vector<std::size_t> offsets_;  ///< in the order of arrays_of
  std::size_t next_ = 0;
};

/// The opening tag of the raw data. VTK reads 4096 bytes at a time and stops at this tag, but expat since its repair of
/// CVE-2023-52425 (Debian 12's 2.5.0-1+deb12u2) puts off an incomplete tag until its bytes have doubled: VTK 9.1 and
/// ParaView 5.11 then run into the raw bytes and read nothing. With the word at the end of a buffer the rest comes byte
/// by byte, expat tries at 26 and 52 bytes of the tag, and VTK's own ending (14 bytes) reaches 52 where the tag has 38
/// to 50: it has 44 here (seen to read with 25, 31 and 37 bytes behind the word, not with 20 and 40).
void begin_appended(std::string& head) {
  constexpr std::string_view word = "<AppendedData";
  constexpr std::size_t buffer = 4096;
  head.append((2 * buffer - word.size() - head.size() % buffer) % buffer, ' ');
  head.append(word).append(" encoding=\"raw\"").append(16, ' ').append(">\n_");
}

/// Head of a file up to the raw data. `d` holds the arrays; offsets are in the order of arrays_of.
std::string head_of(const PolyData& d, const char* compressor, std::vector<std::size_t> offsets, Multiple whole) {
  ArrayTags tags(std::move(offsets));
  std::string head = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{}>\n<PolyData>\n"
      "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{:.17g}</DataArray>"
      "</FieldData>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\">\n",
      compressor, d.time, whole(d.point_count()), whole(d.vertices.size()), whole(d.lines.size()),
      whole(d.polygons.size()));
  head += tags.data("PointData", d.point_data, d.point_count());
  head += tags.data("CellData", d.cell_data, d.vertices.size() + d.lines.size() + d.polygons.size());
  head += "<Points>\n" + tags.array("Points", "Float32", 3) + "</Points>\n";
  for (const char* cells : {"Verts", "Lines", "Polys"}) head += tags.cells(cells);
  head += "</Piece>\n</PolyData>\n";
  begin_appended(head);
  return head;
}

constexpr std::string_view tail = "\n</AppendedData>\n</VTKFile>\n";

/// A new file, written at given offsets.
class PlacedFile {
 public:
  PlacedFile(const std::filesystem::path& side, const std::filesystem::path& named)
      : named_(named), file_(::open(side.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
    if (file_ < 0) fail();
  }
  ~PlacedFile() {
    if (file_ >= 0) ::close(file_);
  }
  PlacedFile(const PlacedFile&) = delete;
  PlacedFile& operator=(const PlacedFile&) = delete;

  void put(std::size_t place, Bytes data) {
    while (!data.empty()) {
      const ssize_t done = ::pwrite(file_, data.data(), data.size(), static_cast<off_t>(place));
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) fail();
      place += static_cast<std::size_t>(done);
      data = data.subspan(static_cast<std::size_t>(done));
    }
  }
  void close() {
    if (::close(std::exchange(file_, -1)) != 0) fail();
  }

 private:
  [[noreturn]] void fail() const {
    throw FileError(named_.string() + ": cannot write the frame: " + std::strerror(errno));
  }
  const std::filesystem::path& named_;
  int file_;
};

}  // namespace

VtpFile::VtpFile(const PolyData& data) {
  std::vector<std::size_t> offsets;
  std::size_t size = 0;
  for (const Bytes bytes : arrays_of(data)) {
    arrays_.push_back(compress_blocks(bytes));
    offsets.push_back(size);
    size += arrays_.back().size();
  }
  head_ = head_of(data, R"( compressor="vtkZLibDataCompressor")", std::move(offsets), {});
}

void VtpFile::write(const std::filesystem::path& path) const {
  SideFile side(path);
  PlacedFile out(side.path(), path);
  std::size_t size = 0;
  const auto add = [&](Bytes bytes) {
    out.put(size, bytes);
    size += bytes.size();
  };
  add(head_);
  for (const std::string& a : arrays_) add(a);
  add(tail);
  out.close();
  side.commit(false);
}

void write_vtp_pieces(const std::filesystem::path& path, const std::vector<std::size_t>& begins,
                      const std::function<PolyData(std::size_t)>& draw) {
  PolyData piece = draw(0);
  const Multiple whole{begins.back(), std::max<std::size_t>(begins[1], 1)};
  std::vector<std::size_t> sizes, offsets;
  std::size_t size = 0;
  for (const Bytes bytes : arrays_of(piece)) {
    sizes.push_back(whole(bytes.size()));
    offsets.push_back(size);
    size += sizeof(std::uint64_t) + sizes.back();
  }
  SideFile side(path);
  PlacedFile out(side.path(), path);
  const std::string head = head_of(piece, "", offsets, whole);
  out.put(0, head);
  std::vector<std::size_t> place;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    std::string word;
    put_word(word, sizes[k]);
    out.put(head.size() + offsets[k], word);
    place.push_back(head.size() + offsets[k] + word.size());
  }
  for (std::size_t next = 1;; ++next) {
    const std::vector<Bytes> arrays = arrays_of(piece);
    for (std::size_t k = 0; k < arrays.size(); ++k) {
      out.put(place[k], arrays[k]);
      place[k] += arrays[k].size();
    }
    if (next + 1 >= begins.size()) break;
    piece = draw(next);
  }
  out.put(head.size() + size, tail);
  out.close();
  side.commit(false);
}

void write_vtp_rows(const std::filesystem::path& path, std::size_t rows,
                    const std::function<PolyData(std::size_t, std::size_t)>& draw) {
  constexpr std::size_t at_once = 2048;
  std::vector<std::size_t> begins{0};
  do begins.push_back(std::min(rows, begins.back() + at_once));
  while (begins.back() < rows);
  write_vtp_pieces(path, begins, [&](std::size_t k) { return draw(begins[k], begins[k + 1]); });
}

}  // namespace epafi
