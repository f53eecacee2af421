#include "viz_export/hdf5/problem_file.h"

#include <filesystem>
#include <fstream>

#include "engine/units/error.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "tests/support/catch.h"
#include "viz_export/hdf5/hdf5_file.h"

using namespace epafi;

namespace {
const std::filesystem::path folder = std::filesystem::path(EPAFI_SOURCE_DIR) / "tests/data/problems";

ConeProblem blocks(const ProblemFile& file) {
  return std::visit([](const auto& form) { return ConeProblem::from(form); }, file.form);
}

/// The residual that `auto` reaches, measured here.
double solved(const ConeProblem& p, double tolerance) {
  Parameters parameters;
  parameters.set("tolerance", tolerance);
  parameters.set("iterations", 5000.0);
  Impulses r(p.size(), Vec3::Zero());
  auto_entry().make(parameters)->solve(p, r);
  std::vector<Vec6> v;
  std::vector<Vec3> u;
  p.relative_velocities(r, v, u);
  return p.residual(r, u);
}
}  // namespace

TEST_CASE("problem files of both forms are read and solved to 1e-9", "[viz_export][problems]") {
  const std::pair<const char*, std::size_t> files[] = {{"stack_h005_mu05.hdf5", 20},
                                                       {"stack_h010_top1e4.hdf5", 40},
                                                       {"arch_21_mu06.hdf5", 88},
                                                       {"OneObject-i100000-316.hdf5.dat", 25},
                                                       {"LMGC_GlobalFrictionContactProblem00046.hdf5", 9}};
  for (const auto& [name, contacts] : files) {
    INFO(name);
    const ConeProblem p = blocks(read_problem(folder / name));
    CHECK(p.size() == contacts);
    CHECK(solved(p, 1e-9) <= 1e-9);
  }
}

TEST_CASE("a written problem reads back to the same matrices", "[viz_export][problems]") {
  const GlobalForm form = std::get<GlobalForm>(read_problem(folder / "stack_h005_mu05.hdf5").form);
  const auto path = std::filesystem::temp_directory_path() / "epafi_problem_round_trip.hdf5";
  write_problem(path, form, "five boxes");
  const GlobalForm again = std::get<GlobalForm>(read_problem(path).form);
  std::filesystem::remove(path);
  CHECK((again.M - form.M).norm() == 0.0);
  CHECK((again.H - form.H).norm() == 0.0);
  CHECK(again.f == form.f);
  CHECK(again.w == form.w);
  CHECK(again.mu == form.mu);
}

TEST_CASE("a problem file that is cut, of another dimension or without friction is refused with its reason",
          "[viz_export][problems]") {
  const auto path = std::filesystem::temp_directory_path() / "epafi_problem_broken.dat";
  const auto message = [&](const std::string& text) -> std::string {
    std::ofstream(path) << text;
    try {
      (void)read_problem(path);
    } catch (const FileError& e) {
      return e.what();
    }
    return "accepted";
  };
  CHECK(message("2\n1\n0\n").find("three dimensions") != std::string::npos);
  CHECK(message("3\n1\n0\n3 3\n1 0 0 0 1 0 0 0").find("W should stand") != std::string::npos);
  CHECK(message("3\n1\n0\n3 3\n1 0 0 0 1 0 0 0 1\n-1 0 0\n-0.5").find("friction") != std::string::npos);
  CHECK(message("3\n1\n0\n3 3\n1 0 0 0 1 0 0 0 1\n-1 0 0\n0.5") == "accepted");
  std::filesystem::remove(path);
  CHECK_THROWS_AS(read_problem(folder / "README.md"), FileError);
}

TEST_CASE("a problem whose matrix claims more than its vectors hold is refused before memory is taken",
          "[viz_export][problems]") {
  const auto path = std::filesystem::temp_directory_path() / "epafi_problem_claims.hdf5";
  const auto message = [&](const std::string& name, std::int32_t value) -> std::string {
    std::filesystem::copy_file(folder / "stack_h005_mu05.hdf5", path,
                               std::filesystem::copy_options::overwrite_existing);
    {
      Hdf5File file(path, Hdf5File::Mode::append);
      file.remove(name);
      file.write<std::int32_t>(name, std::span<const std::int32_t>(&value, 1));
      file.close();
    }
    try {
      (void)read_problem(path);
    } catch (const FileError& e) {
      return e.what();
    }
    return "accepted";
  };
  CHECK_NOTHROW(read_problem(folder / "stack_h005_mu05.hdf5"));
  for (const std::int32_t claim : {1 << 30, -1, 7}) {
    CHECK(message("fclib_global/M/n", claim).find("the vectors ask for 30 x 30") != std::string::npos);
    CHECK(message("fclib_global/H/m", claim).find("the vectors ask for 30 x 60") != std::string::npos);
  }
  std::filesystem::remove(path);
}

TEST_CASE("a block matrix in text whose rows do not begin in order is refused", "[viz_export][problems]") {
  const auto path = std::filesystem::temp_directory_path() / "epafi_problem_rows.dat";
  std::ofstream(path) << "3\n2\n1\n6 6\n1 2 2\n3 6\n3 6\n3\n1\n0 7 1\n0\n3 1 0 0 0 1 0 0 0 1\n";
  CHECK_THROWS_WITH(read_problem(path), Catch::Contains("block pattern is inconsistent"));
  std::filesystem::remove(path);
}

TEST_CASE("a problem file with any address beyond its end is read or refused, never followed",
          "[viz_export][problems][long]") {
  std::ifstream in(folder / "LMGC_GlobalFrictionContactProblem00046.hdf5", std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  const auto path = std::filesystem::temp_directory_path() / "epafi_address_outside.hdf5";
  const auto is_refused = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    try {
      static_cast<void>(read_problem(path));
      return false;
    } catch (const FileError& e) {
      const std::string text(e.what());
      CHECK(text.find(path.string()) == 0);
      return true;
    }
  };
  REQUIRE_FALSE(is_refused(whole));
  const std::string mark("HEAP\0\0\0\0", 8);
  std::size_t refused = 0, heaps = 0;
  for (std::size_t at = 0; at + 8 <= std::min<std::size_t>(whole.size(), 4096); at += 8)
    for (const char* value : {"\xff\xff\xff\xff\xff\xff\xff\xff", "\xf0\xff\xff\xff\xff\xff\xff\x7f"}) {
      std::string broken = whole;
      broken.replace(at, 8, value, 8);
      refused += is_refused(broken);
    }
  for (std::size_t at = whole.find(mark); at != whole.npos; at = whole.find(mark, at + 1)) {
    ++heaps;
    for (const std::size_t field : {8, 24}) {  // size and address of the names of a group
      std::string broken = whole;
      broken.replace(at + field, 8, 8, '\xff');
      CHECK(is_refused(broken));
    }
  }
  CHECK((heaps >= 1 && refused > 20));
  std::filesystem::remove(path);
}
