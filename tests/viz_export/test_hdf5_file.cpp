#include "viz_export/hdf5/hdf5_file.h"

#include <unistd.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <fstream>
#include <numeric>

#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"

using namespace epafi;
using Catch::Contains;

namespace {

std::vector<double> counting(std::size_t n) {
  std::vector<double> v(n);
  std::iota(v.begin(), v.end(), 0.5);
  return v;
}

template <class T>
void check_round_trip(Hdf5File& file, const std::string& name, const std::vector<T>& values, const Hdf5Layout& layout) {
  file.write<T>(name, values, layout);
  CHECK(file.read<T>(name) == values);
}

}  // namespace

TEST_CASE("datasets of every type and layout come back as they were written", "[viz_export][hdf5]") {
  const TemporaryFolder folder;
  Hdf5File file(folder / "a.h5", Hdf5File::Mode::create);
  const Hdf5Layout packed{.columns = 3, .compressed = true}, growing{.columns = 1, .extendable = true};
  check_round_trip<double>(file, "deep/down/d", counting(300), packed);
  check_round_trip<float>(file, "f", {1.5f, -2.25f}, {});
  check_round_trip<std::int32_t>(file, "i", {-7, 7, 2147483647}, growing);
  check_round_trip<std::uint8_t>(file, "bytes", {0, 255, 17}, {});
  check_round_trip<std::uint64_t>(file, "u", {~std::uint64_t{0}, 0}, {.columns = 2});
  check_round_trip<double>(file, "none", {}, {});
  check_round_trip<double>(file, "none_growing", {}, growing);
  CHECK(file.shape("deep/down/d") == std::vector<std::size_t>{100, 3});
  CHECK(file.has("deep/down"));
  CHECK_FALSE(file.has("deep/up/d"));
  CHECK(file.children("/") == std::vector<std::string>{"bytes", "deep", "f", "i", "none", "none_growing", "u"});
}

TEST_CASE("a dataset written by pieces is the one written at once", "[viz_export][hdf5]") {
  const TemporaryFolder folder;
  Hdf5File file(folder / "a.h5", Hdf5File::Mode::create);
  for (const std::size_t rows : {0u, 1u, 16384u, 40001u}) {
    const auto all = counting(3 * rows);
    std::size_t behind = 0;
    file.write_pieces<double>("p" + std::to_string(rows), rows, 3,
                              [&](std::size_t first, std::size_t count, double* to) {
                                CHECK(first == behind);
                                std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(3 * first), 3 * count, to);
                                behind += count;
                              });
    CHECK(behind == rows);
    CHECK(file.read<double>("p" + std::to_string(rows)) == all);
    CHECK(file.shape("p" + std::to_string(rows)) == std::vector<std::size_t>{rows, 3});
  }
  file.write_pieces<std::uint32_t>("flat", 20000, 1, [](std::size_t first, std::size_t count, std::uint32_t* to) {
    std::iota(to, to + count, static_cast<std::uint32_t>(first));
  });
  CHECK(file.shape("flat") == std::vector<std::size_t>{20000});
  CHECK(file.read<std::uint32_t>("flat")[16384] == 16384);
}

TEST_CASE("an extendable dataset grows, shrinks and grows again over file openings", "[viz_export][hdf5]") {
  const TemporaryFolder folder;
  const auto path = folder / "a.h5";
  const auto all = counting(5000);
  {
    Hdf5File file(path, Hdf5File::Mode::create);
    file.write<double>("x", {}, {.columns = 2, .extendable = true, .chunk_rows = 64});
    file.append<double>("x", std::span(all).first(3000));
    file.close();
  }
  Hdf5File file(path, Hdf5File::Mode::append);
  file.truncate("x", 1000);
  file.append<double>("x", std::span(all).subspan(2000));
  CHECK(file.shape("x") == std::vector<std::size_t>{2500, 2});
  CHECK(file.read<double>("x") == all);
}

TEST_CASE("attributes and texts keep empty strings, UTF-8 and exact numbers", "[viz_export][hdf5]") {
  const TemporaryFolder folder;
  Hdf5File file(folder / "a.h5", Hdf5File::Mode::create);
  const std::string text = "title = \"Kies, 10 \u00b5m\"\n[run]\n";
  file.write_text("scene", text);
  file.write_text("empty", "");
  file.make_group("g");
  // the second replaces the first
  file.set_attribute("g", "time", 0.1);
  file.set_attribute("g", "time", 0.2);
  file.set_attribute("/", "steps", ~std::uint64_t{0});
  file.set_attribute("/", "nothing", std::string());
  CHECK(file.read_text("scene") == text);
  CHECK(file.read_text("empty").empty());
  CHECK(file.number_attribute("g", "time") == 0.2);
  CHECK(file.count_attribute("/", "steps") == ~std::uint64_t{0});
  CHECK(file.text_attribute("/", "nothing").empty());
  CHECK_FALSE(file.has_attribute("/", "time"));
  CHECK_THROWS_WITH(file.count_attribute("g", "time"), Contains("whole number"));
  CHECK_THROWS_WITH(file.number_attribute("g", "mass"), Contains("mass") && Contains("a.h5"));
}

TEST_CASE("reading refuses what is not there, of another type or larger than the file", "[viz_export][hdf5]") {
  const TemporaryFolder folder;
  const auto path = folder / "a.h5";
  CHECK_THROWS_WITH(Hdf5File(path, Hdf5File::Mode::read), Contains("no such file"));
  CHECK_THROWS_AS(Hdf5File(folder / "no_folder/a.h5", Hdf5File::Mode::create), FileError);
  Hdf5File file(path, Hdf5File::Mode::create);
  file.write<double>("x", counting(10));
  CHECK_THROWS_WITH(file.read<std::int64_t>("x"), Contains("another type"));
  CHECK_THROWS_WITH(file.read<float>("x"), Contains("another type"));  // would lose digits
  CHECK_THROWS_WITH(file.read<double>("y"), Contains("'y'"));
  std::vector<double> eleven(11);
  CHECK_THROWS_WITH(file.read_into("x", eleven.data(), eleven.size()), Contains("11 elements"));
  CHECK_THROWS_WITH(file.write<double>("x", counting(3)), Contains("'x'"));  // there is one already
}

TEST_CASE("files of other programs: claims beyond the file are refused before memory is taken", "[viz_export][hdf5]") {
  const Hdf5File file(std::string(EPAFI_SOURCE_DIR) + "/tests/data/viz_export/claims_too_much.h5",
                      Hdf5File::Mode::read);
  CHECK_THROWS_WITH(file.read<double>("unwritten"), Contains("claims 8796093022208 bytes but the file holds 0"));
  CHECK_THROWS_WITH(file.read<double>("overflow"), Contains("claims more than 2^64 bytes"));
  CHECK_THROWS_WITH(file.read<double>("zeros"), Contains("claims 8796093022208 bytes"));
  CHECK(file.read<double>("big_endian") == std::vector<double>{1.5, 2.5});
  CHECK(file.read<std::int64_t>("ok") == std::vector<std::int64_t>{1, 2, 3});
  CHECK(file.read_text("name") == "variable text \u00b5");
}

TEST_CASE("a cut file and one that is not HDF5 are refused by name and cause", "[viz_export][hdf5]") {
  const TemporaryFolder folder;
  const auto path = folder / "a.h5";
  {
    Hdf5File file(path, Hdf5File::Mode::create);
    file.write<double>("x", counting(10000));
    file.close();
  }
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  CHECK_THROWS_WITH(Hdf5File(path, Hdf5File::Mode::read), Contains("a.h5: is cut short"));
  write_whole_file(path, {"this is text"});
  CHECK_THROWS_WITH(Hdf5File(path, Hdf5File::Mode::read), Contains("a.h5: is no HDF5 file"));
}

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace {
/// What this process holds beside its code [B].
double held_bytes() {
  malloc_trim(0);  // what earlier cases have freed
  std::ifstream statm("/proc/self/statm");
  double all = 0.0, pages = 0.0, of_files = 0.0;
  statm >> all >> pages >> of_files;
  return (pages - of_files) * static_cast<double>(sysconf(_SC_PAGESIZE));
}
}  // namespace

TEST_CASE("an open file of many small datasets stays small in memory", "[viz_export][hdf5][memory]") {
  // 24 kB for each group of three without a limit; with it 256 kB of what lies in the file, 30 times as much in memory
  const TemporaryFolder folder;
  const double before = held_bytes();
  Hdf5File file(folder / "many.h5", Hdf5File::Mode::create);
  for (int k = 0; k < 2500; ++k) {
    const std::string group = "shapes/" + std::to_string(k);
    file.write<double>(group + "/points", counting(24), {.columns = 3});
    file.write<std::int32_t>(group + "/connectivity", std::vector<std::int32_t>(24, k));
    file.write<std::int32_t>(group + "/offsets", std::vector<std::int32_t>(6, k));
  }
  CHECK(held_bytes() - before < 20e6);                                                      // 60e6 otherwise
  CHECK(file.read<std::int32_t>("shapes/17/offsets") == std::vector<std::int32_t>(6, 17));  // written out, read again
  CHECK(file.read<double>("shapes/2400/points") == counting(24));
  file.close();
}
#endif
