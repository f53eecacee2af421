#include "viz_export/vtp_writer.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <span>
#include <sstream>
#include <string_view>

#include "engine/error.h"
#include "engine/parallel.h"
#include "viz_export/side_file.h"

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
    uLongf size = compressBound(static_cast<uLong>(end - begin));
    streams[b].resize(size);
    const auto* from = reinterpret_cast<const Bytef*>(data.data() + begin);
    const int status =
        compress2(reinterpret_cast<Bytef*>(streams[b].data()), &size, from, static_cast<uLong>(end - begin), 1);
    streams[b].resize(status == Z_OK ? size : 0);
  });
  std::string out;
  put_word(out, blocks), put_word(out, block_bytes), put_word(out, data.size() % block_bytes);
  for (const std::string& s : streams) {
    if (s.empty()) throw FileError("zlib ran out of memory");
    put_word(out, s.size());
  }
  for (const std::string& s : streams) out += s;
  return out;
}

/// Collects the appended section while the XML head is written: each array is named by its offset.
class Appended {
 public:
  Appended(VtpEncoding encoding, std::vector<VtpPart>& parts) : encoding_(encoding), parts_(parts) {}
  /// `data` must live as long as the parts.
  std::size_t add(Bytes data) {
    const std::size_t offset = size_;
    std::string head;
    if (encoding_ == VtpEncoding::compressed) {
      head = compress_blocks(data);
      data = {};
    } else {
      put_word(head, data.size());
    }
    size_ += head.size() + data.size();
    parts_.push_back({std::move(head), data});
    return offset;
  }

 private:
  VtpEncoding encoding_;
  std::vector<VtpPart>& parts_;
  std::size_t size_ = 0;
};

std::string array_tag(Appended& appended, const std::string& name, const char* type, int components, Bytes data) {
  return fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)", type,
                     name, components, appended.add(data)) +
         "\n";
}

std::string cells_tag(Appended& appended, const char* tag, const VtpCells& cells) {
  return fmt::format("<{}>\n", tag) + array_tag(appended, "connectivity", "Int32", 1, bytes_of(cells.connectivity)) +
         array_tag(appended, "offsets", "Int32", 1, bytes_of(cells.offsets)) + fmt::format("</{}>\n", tag);
}

std::string data_tag(Appended& appended, const char* tag, const std::vector<VtpArray>& arrays, std::size_t tuples) {
  std::string out = fmt::format("<{}>\n", tag);
  for (const VtpArray& a : arrays) {
    std::visit(
        [&](const auto& values) {
          EPAFI_REQUIRE(values.size() == tuples * static_cast<std::size_t>(a.components),
                        "one tuple per point or cell");
          using T = typename std::decay_t<decltype(values)>::value_type;
          out += array_tag(appended, a.name, type_name(T{}), a.components, bytes_of(values));
        },
        a.values);
  }
  (void)tuples;
  return out + fmt::format("</{}>\n", tag);
}

/// The opening tag of the raw data. VTK reads 4096 bytes at a time and stops at this tag, but expat since its repair of
/// CVE-2023-52425 (Debian 12's 2.5.0-1+deb12u2) puts off an incomplete tag until its bytes have doubled: VTK 9.1 and ParaView 5.11
/// then run into the raw bytes and read nothing. With the word at the end of a buffer the rest comes byte by byte, expat tries at 26
/// and 52 bytes of the tag, and VTK's own ending (14 bytes) reaches 52 where the tag has 38 to 50: it has 44 here (seen to read
/// with 25, 31 and 37 bytes behind the word, not with 20 and 40).
void begin_appended(std::string& head) {
  constexpr std::string_view word = "<AppendedData";
  constexpr std::size_t buffer = 4096;
  head.append((2 * buffer - word.size() - head.size() % buffer) % buffer, ' ');
  head.append(word).append(" encoding=\"raw\"").append(16, ' ').append(">\n_");
}

}  // namespace

VtpFile::VtpFile(PolyData data, VtpEncoding encoding) : data_(std::move(data)) {
  const PolyData& d = data_;
  Appended appended(encoding, parts_);
  const char* compressor = encoding == VtpEncoding::compressed ? R"( compressor="vtkZLibDataCompressor")" : "";
  std::string& head = head_;
  head = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{}>\n<PolyData>\n"
      "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{:.17g}</DataArray>"
      "</FieldData>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"{}\">\n",
      compressor, d.time, d.point_count(), d.vertices.size(), d.lines.size(), d.polygons.size());
  head += data_tag(appended, "PointData", d.point_data, d.point_count());
  head += data_tag(appended, "CellData", d.cell_data, d.vertices.size() + d.lines.size() + d.polygons.size());
  head += "<Points>\n" + array_tag(appended, "Points", "Float32", 3, bytes_of(d.points)) + "</Points>\n";
  head += cells_tag(appended, "Verts", d.vertices) + cells_tag(appended, "Lines", d.lines);
  head += cells_tag(appended, "Polys", d.polygons);
  head += "</Piece>\n</PolyData>\n";
  begin_appended(head);
}

void VtpFile::write(const std::filesystem::path& path) const {
  SideFile side(path);
  std::ofstream out(side.path(), std::ios::binary);
  out << head_;
  for (const VtpPart& p : parts_) {
    out.write(p.head.data(), static_cast<std::streamsize>(p.head.size()));
    out.write(p.data.data(), static_cast<std::streamsize>(p.data.size()));
  }
  out << "\n</AppendedData>\n</VTKFile>\n";
  out.close();
  if (!out) throw FileError(path.string() + ": cannot write the frame (is the disk full?)");
  side.commit(false);
}

void write_vtp(const std::filesystem::path& path, PolyData data, VtpEncoding encoding) {
  VtpFile(std::move(data), encoding).write(path);
}

namespace {

/// Value of attribute `key` in a line of our own .pvd.
std::optional<std::string> attribute(const std::string& line, const std::string& key) {
  const std::string start = key + "=\"";
  const std::size_t begin = line.find(start);
  if (begin == std::string::npos) return std::nullopt;
  const std::size_t end = line.find('"', begin + start.size());
  if (end == std::string::npos) return std::nullopt;
  return line.substr(begin + start.size(), end - begin - start.size());
}

template <class T>
bool parse(const std::optional<std::string>& text, T& value) {
  if (!text) return false;
  const char* end = text->data() + text->size();
  const auto result = std::from_chars(text->data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

}  // namespace

void PvdFile::keep_until(double time) {
  entries_.clear();
  std::istringstream in(read_whole_file(path_));
  for (std::string line; std::getline(in, line);) {
    if (line.find("<DataSet") == std::string::npos) continue;
    Entry e{};
    const auto file = attribute(line, "file");
    if (!parse(attribute(line, "timestep"), e.time) || !parse(attribute(line, "part"), e.part) || !file)
      throw FileError(path_.string() + ": is not a list of frames as Epafi writes it: '" + line + "'");
    e.file = *file;
    if (e.time <= time) entries_.push_back(e);
  }
}

void PvdFile::add(double time, int part, const std::string& file) { entries_.push_back({time, part, file}); }

void PvdFile::write() const {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<Collection>\n";
  for (const Entry& e : entries_)
    text += fmt::format("<DataSet timestep=\"{:.17g}\" part=\"{}\" file=\"{}\"/>\n", e.time, e.part, e.file);
  write_whole_file(path_, {text, "</Collection>\n</VTKFile>\n"});
}

}  // namespace epafi
