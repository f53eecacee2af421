// `epafi solve`: its rows, and that the impulses it writes solve the problem of the file.
#include <Eigen/SparseCholesky>
#include <sstream>

#include "engine/units/error.h"
#include "scenes/cli/commands.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/hdf5/hdf5_file.h"
#include "viz_export/hdf5/problem_file.h"

using namespace epafi;

namespace {

const std::string problem_files = EPAFI_SOURCE_DIR "/tests/data/problems/";

std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream in(csv);
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

SolveOptions solving(std::vector<std::string> files, std::vector<std::string> methods) {
  SolveOptions o;
  for (auto& file : files) o.problems.push_back(problem_files + file);
  o.methods = std::move(methods);
  return o;
}

/// u = H^T M^-1 (f + H r) + w, by sparse Cholesky: nothing of the solvers is in it.
Eigen::VectorXd contact_velocities(const GlobalForm& form, const Eigen::VectorXd& r) {
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(form.M);
  REQUIRE(factor.info() == Eigen::Success);
  return form.H.transpose() * factor.solve(form.f + form.H * r) + form.w;
}

}  // namespace

TEST_CASE("solve prints a row per problem and method, and writes impulses that obey Signorini and Coulomb",
          "[scenes][solve][long]") {
  const TemporaryFolder folder;
  SolveOptions o = solving({"stack_h010_mu05.hdf5", "arch_21_mu06.hdf5"}, {"newton", "nsgs"});
  o.tolerance = 1e-8;
  o.solution = (folder / "reactions.h5").string();
  o.time_limit = "300s";  // on an instrumented program 10 s were not enough
  const Captured run = captured([&] { return command_solve(o); });
  CHECK(run.code == exit_done);
  const auto rows = rows_of(run.out);
  REQUIRE(rows.size() == 5);
  CHECK(rows[0] == std::vector<std::string>{"problem", "method", "status", "iterations", "ms", "residual",
                                            "penetration_rate", "sweep_equivalents", "reason"});
  Hdf5File solution(o.solution, Hdf5File::Mode::read);
  for (const std::size_t k : {1, 3}) {  // <problem>/reaction is that of the least residual
    const std::size_t best = std::stod(rows[k][5]) <= std::stod(rows[k + 1][5]) ? k : k + 1;
    CHECK(solution.read<double>(rows[k][0] + "/reaction") ==
          solution.read<double>(rows[k][0] + "/" + rows[best][1] + "/reaction"));
  }
  for (std::size_t k = 1; k < rows.size(); ++k) {
    REQUIRE(rows[k].size() == 8);  // no reason beside "solved"
    INFO(rows[k][0] << " " << rows[k][1]);
    CHECK(rows[k][2] == "solved");
    CHECK(std::stod(rows[k][5]) <= 1e-8);
    const GlobalForm form = std::get<GlobalForm>(read_problem(problem_files + rows[k][0] + ".hdf5").form);
    const std::vector<double> flat = solution.read<double>(rows[k][0] + "/" + rows[k][1] + "/reaction");
    REQUIRE(flat.size() == static_cast<std::size_t>(form.w.size()));
    const Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(flat.data(), form.w.size());
    const Eigen::VectorXd u = contact_velocities(form, r);
    const double scale = 9.81 * 5e-3, most = r.cwiseAbs().maxCoeff();  // of velocities: one step of gravity
    for (Eigen::Index i = 0; i < form.mu.size(); ++i) {
      const double rn = r[3 * i], rt = r.segment(3 * i + 1, 2).norm(), mu = form.mu[i];
      CHECK(rn >= -1e-7 * most);
      CHECK(rt <= mu * rn + 1e-7 * most);
      CHECK(u[3 * i] >= -1e-6 * scale);
      CHECK(std::abs(rn * u[3 * i]) <= 1e-6 * scale * most);
      if (rt < 0.99 * mu * rn) CHECK(u.segment(3 * i + 1, 2).norm() <= 1e-5 * scale);  // it sticks
    }
  }
}

TEST_CASE("solve says why a problem was left: iterations, time, a method that does not apply", "[scenes][solve]") {
  SolveOptions o = solving({"stack_h050_mu05.hdf5"}, {"pgs"});
  o.max_iterations = 5;
  o.json = true;
  const Captured few = captured([&] { return command_solve(o); });
  CHECK_THAT(few.out, Catch::Contains("\"status\": \"iteration_limit\"") && Catch::Contains("\"iterations\": 5"));
  const TemporaryFolder folder;
  o = solving({"stack_h050_mu05.hdf5"}, {"pgs"});
  o.tolerance = 1e-14;
  o.time_limit = "0.001s";
  o.out = (folder / "rows.csv").string();
  CHECK(captured([&] { return command_solve(o); }).out.empty());
  std::ifstream in(o.out);
  const auto rows = rows_of(std::string(std::istreambuf_iterator<char>(in), {}));
  REQUIRE(rows.size() == 2);
  CHECK(rows[1][2] == "time_limit");
  CHECK(std::stod(rows[1][5]) > 1e-14);
}

TEST_CASE("solve names problems without solution, whatever the method says, and exits with 1", "[scenes][solve]") {
  SolveOptions o = solving({"no_solution_ray.hdf5", "no_solution_zero_row.hdf5"},
                           {"apgd", "projected-gradient", "lemke", "dantzig", "adaptive"});
  o.time_limit = "0.2s";
  const Captured run = captured([&] { return command_solve(o); });
  CHECK(run.code == exit_bound);
  const auto rows = rows_of(run.out);
  REQUIRE(rows.size() == 11);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    INFO(rows[k][0] << " " << rows[k][1]);
    CHECK(rows[k][2] == "no_solution");
    CHECK_THAT(rows[k].back(),
               Catch::Contains(k <= 5 ? "ray: contacts 0 and 1" : "zero row: no impulse moves contact 1"));
  }
}

TEST_CASE("solve with all methods tries each, on both forms of files", "[scenes][solve][long]") {
  SolveOptions o = solving({"stack_h005_mu05.hdf5", "OneObject-i100000-316.hdf5.dat"}, {"all"});
  o.tolerance = 1e-4;
  o.time_limit = "0.3s";
  const auto rows = rows_of(captured([&] { return command_solve(o); }).out);
  std::map<std::string, int> solved;
  for (std::size_t k = 1; k < rows.size(); ++k) solved[rows[k][0]] += rows[k][2] == "solved";
  CHECK(solved.size() == 2);
  for (const auto& [problem, count] : solved) {
    INFO(problem << ": " << count << " of " << (rows.size() - 1) / 2);
    CHECK(count >= 5);
  }
}

TEST_CASE("solve refuses what it does not know, with the nearest", "[scenes][solve]") {
  CHECK_THROWS_WITH(command_solve(solving({"stack_h005_mu05.hdf5"}, {"newtn"})),
                    Catch::Contains("unknown solver 'newtn'; did you mean 'newton'?"));
  SolveOptions o = solving({"stack_h005_mu05.hdf5"}, {});
  o.time_limit = "soon";
  CHECK_THROWS_WITH(command_solve(o), Catch::Contains("'soon' is no duration"));
  const Captured gone = captured([] { return guarded([] { return command_solve(solving({"none.hdf5"}, {})); }); });
  CHECK(gone.code == exit_file);
  CHECK_THAT(gone.err, Catch::Contains("none.hdf5"));
}

TEST_CASE("a solution file that two problems of one name would share is refused", "[scenes][solve]") {
  const TemporaryFolder folder;
  SolveOptions o = solving({"stack_h010_mu05.hdf5", "stack_h010_mu05.hdf5"}, {"newton"});
  o.solution = (folder / "reactions.h5").string();
  CHECK_THROWS_WITH(captured([&] { return command_solve(o); }),
                    Catch::Contains("two problems are named 'stack_h010_mu05'"));
}
