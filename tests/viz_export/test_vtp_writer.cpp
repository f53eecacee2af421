#include "viz_export/vtk/pvd_file.h"
#include "viz_export/vtk/vtp_writer.h"

#include <cstring>

#include "engine/units/error.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"

using namespace epafi;

namespace {

/// The bytes of one array of an uncompressed file, found as a VTK reader finds them: by its offset behind the
/// underscore.
std::string array_bytes(const std::string& file, const std::string& name) {
  const std::size_t tag = file.find("Name=\"" + name + "\"");
  REQUIRE(tag != std::string::npos);
  const std::size_t offset = std::stoul(file.substr(file.find("offset=\"", tag) + 8));
  const std::size_t start = file.find(">\n_", file.find("<AppendedData encoding=\"raw\"")) + 3 + offset;
  std::uint64_t size = 0;
  std::memcpy(&size, file.data() + start, 8);
  return file.substr(start + 8, size);
}

template <class T>
std::string bytes(const std::vector<T>& v) {
  return {reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T)};
}

PolyData triangle() {
  PolyData d;
  d.time = 0.1;
  d.points = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  d.polygons = {{0, 1, 2}, {3}};
  d.point_data.push_back({"height", 1, VtpColumn<double>{1, 2, 3}});
  d.cell_data.push_back({"id", 1, VtpColumn<std::uint32_t>{7}});
  return d;
}

}  // namespace

TEST_CASE("arrays of a .vtp stand where their offsets say, behind their size", "[viz_export][vtp]") {
  const TemporaryFolder folder;
  write_vtp_rows(folder / "a.vtp", 1, [&](std::size_t, std::size_t) { return triangle(); });
  const std::string file = read_whole_file(folder / "a.vtp");
  CHECK(array_bytes(file, "Points") == bytes<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
  CHECK(array_bytes(file, "height") == bytes<double>({1, 2, 3}));
  CHECK(array_bytes(file, "id") == bytes<std::uint32_t>({7}));
  CHECK_THAT(
      file,
      Catch::Contains(
          "NumberOfPoints=\"3\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"1\""));
  CHECK_THAT(file, Catch::Contains(">0.10000000000000001<") && Catch::EndsWith("</VTKFile>\n"));
}

TEST_CASE("the list of frames keeps its times exactly and drops those after a checkpoint", "[viz_export][vtp]") {
  const TemporaryFolder folder;
  PvdFile list(folder / "a.pvd");
  for (int k = 0; k < 5; ++k) {
    list.add(0.1 * k, 0, "frames/a" + std::to_string(k) + ".vtp");
    list.add(0.1 * k, 3, "frames/w.vtp");
  }
  list.write();
  PvdFile again(folder / "a.pvd");
  again.keep_until(0.1 * 3);
  REQUIRE(again.entries().size() == 8);
  CHECK((again.entries()[7].time == 0.1 * 3 && again.entries()[7].part == 3 &&
         again.entries()[6].file == "frames/a3.vtp"));
  PvdFile pieces(folder / "b.pvd");  // appended to in place: the same bytes as at once
  for (int k = 0; k < 5; ++k) {
    pieces.add(0.1 * k, 0, "frames/a" + std::to_string(k) + ".vtp");
    pieces.add(0.1 * k, 3, "frames/w.vtp");
    pieces.write();
  }
  const std::string whole = read_whole_file(folder / "a.pvd");
  CHECK(read_whole_file(folder / "b.pvd") == whole);
  const std::size_t tags = whole.find("</Collection>");
  for (const std::size_t cut : {tags - 1, tags - 20, tags + 3}) {  // a crash while the last line is written
    write_whole_file(folder / "c.pvd", {whole.substr(0, cut)});
    PvdFile torn(folder / "c.pvd");
    torn.keep_until(1e9);
    CHECK(torn.entries().size() == (cut < tags - 1 ? 9 : 10));
  }
  write_whole_file(folder / "a.pvd", {"<DataSet timestep=\"x\" part=\"0\" file=\"a\"/>\n"});
  CHECK_THROWS_AS(again.keep_until(1.0), FileError);
}

TEST_CASE("a frame that cannot be written is an error that names it", "[viz_export][vtp]") {
  const TemporaryFolder folder;
  const auto draw = [](std::size_t, std::size_t) { return triangle(); };
  CHECK_THROWS_WITH(write_vtp_rows(folder / "no/a.vtp", 1, draw), Catch::Contains("no/a.vtp: cannot write"));
  std::filesystem::create_symlink("/dev/full", folder / "a.vtp.part");
  CHECK_THROWS_WITH(write_vtp_rows(folder / "a.vtp", 1, draw),
                    Catch::Contains("a.vtp: cannot write the frame: No space left"));
  CHECK_FALSE(std::filesystem::exists(folder / "a.vtp"));
}

TEST_CASE("rows that are drawn a few at a time make the file of all at once", "[viz_export][vtp]") {
  const TemporaryFolder folder;
  const auto draw = [](std::size_t begin, std::size_t end) {
    PolyData d;
    d.time = 0.5;
    VtpColumn<std::uint16_t> number;
    for (std::size_t k = begin; k < end; ++k) {
      for (int c = 0; c < 6; ++c) d.points.push_back(static_cast<float>(6 * k) + static_cast<float>(c));
      for (std::size_t c = 0; c < 2; ++c) d.lines.connectivity.push_back(static_cast<std::int32_t>(2 * k + c));
      d.lines.offsets.push_back(static_cast<std::int32_t>(2 * k + 2));
      number.push_back(static_cast<std::uint16_t>(k));
    }
    d.cell_data.push_back({"number", 1, number});
    return d;
  };
  for (const std::size_t rows : {0u, 1u, 2047u, 2048u, 2049u, 10000u}) {
    write_vtp_rows(folder / "rows.vtp", rows, draw);
    write_vtp_rows(folder / "whole.vtp", 1, [&](std::size_t, std::size_t) { return draw(0, rows); });
    const std::string file = read_whole_file(folder / "rows.vtp");
    CHECK(file == read_whole_file(folder / "whole.vtp"));
    CHECK(array_bytes(file, "Points").size() == 24 * rows);
    CHECK(array_bytes(file, "number").size() == 2 * rows);
    if (rows < 100) continue;
    const std::vector<std::size_t> begins{0, 7, 8, 100, rows};  // pieces of any size
    write_vtp_pieces(folder / "pieces.vtp", begins, [&](std::size_t k) { return draw(begins[k], begins[k + 1]); });
    CHECK(read_whole_file(folder / "pieces.vtp") == file);
  }
}

TEST_CASE("the raw data begin where a parser that waits for more bytes still sees the end of the tag",
          "[viz_export][vtp]") {
  // VTK hands its parser 4096 bytes at a time, ends the document itself behind the tag, and a careful expat tries an
  // incomplete tag again at 2, 4, 8 ... times the bytes it had: from the 13 of its word at 26 and at 52
  const TemporaryFolder folder;
  for (std::size_t arrays : {0u, 1u, 7u, 40u}) {
    PolyData data = triangle();
    for (std::size_t k = 0; k < arrays; ++k)
      data.point_data.push_back({"a" + std::to_string(k), 1, VtpColumn<double>{1, 2, 3}});
    write_vtp_rows(folder / "x.vtp", 1, [&](std::size_t, std::size_t) { return data; });
    const std::string text = read_whole_file(folder / "x.vtp");
    const std::size_t tag = text.find("<AppendedData"), end = text.find('>', tag),
                      ended = end - tag + 1 + 13;  // "/>" in place of ">", "\n</VTKFile>\n"
    CHECK((tag + 13) % 4096 == 0);
    CHECK(end - tag + 1 < 52);
    CHECK(ended >= 52);
    CHECK(text.compare(end, 3, ">\n_") == 0);
  }
}
