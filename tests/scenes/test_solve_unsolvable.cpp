// What `epafi solve` states of problems without solution is true of the impulses it returns: random rays and zero rows,
// every solver, against sums that are rounded once.
#include "engine/threads/exact_sum.h"
#include "engine/units/random.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "scenes/cli/commands.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/hdf5/hdf5_file.h"
#include "viz_export/hdf5/problem_file.h"

using namespace epafi;

namespace {

/// A column of bodies between two walls that close, or one body with contacts that nothing moves among others.
/// All numbers are multiples of 1/64, so that H^T M^-1 H has no rounding.
struct Unsolvable {
  GlobalForm form;
  double closing = 0.0;  ///< -d . q_N [m/s]
  double d_sum = 0.0, d_square = 0.0;
};

using Triplets = std::vector<Eigen::Triplet<double>>;

double dyadic(Random& random, double low, double high) { return std::round(64.0 * random.uniform(low, high)) / 64.0; }

void fill_column(Triplets& h, Eigen::Index body, Eigen::Index column, Random& random, double sign,
                 const std::array<double, 6>& axis) {
  for (int k = 0; k < 6; ++k) {
    const auto row = static_cast<int>(6 * body + k), at = static_cast<int>(column);
    h.emplace_back(row, at, sign * axis[static_cast<std::size_t>(k)]);
    for (int c = 1; c < 3; ++c) h.emplace_back(row, at + c, sign * dyadic(random, -1, 1));
  }
}

Unsolvable random_problem(Random& random, bool ray, double friction) {
  Unsolvable out;
  const auto bodies = static_cast<Eigen::Index>(1 + random.uniform(0, 4));
  const Eigen::Index n = bodies + 1;
  Triplets m, h;
  for (int k = 0; k < 6 * bodies; ++k) m.emplace_back(k, k, std::ldexp(1.0, static_cast<int>(random.uniform(-3, 4))));
  std::array<double, 6> axis{};
  for (double& x : axis) x = dyadic(random, -1, 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!ray && i == n - 1) break;  // its columns stay 0
    if (i > 0) fill_column(h, i - 1, 3 * i, random, -1.0, axis);
    if (i < bodies) fill_column(h, i, 3 * i, random, 1.0, axis);
  }
  GlobalForm& f = out.form;
  f.M.resize(6 * bodies, 6 * bodies);
  f.H.resize(6 * bodies, 3 * n);
  f.M.setFromTriplets(m.begin(), m.end());
  f.H.setFromTriplets(h.begin(), h.end());
  f.f = Eigen::VectorXd::Zero(6 * bodies);
  f.w = Eigen::VectorXd::Zero(3 * n);
  f.mu = Eigen::VectorXd::Constant(n, friction);
  for (Eigen::Index i = 0; i < 3 * n; ++i) f.w(i) = dyadic(random, -1, 1);
  double& last = f.w(3 * n - 3);
  out.closing = dyadic(random, 0.1, 1);
  last = -out.closing;
  for (Eigen::Index i = 0; ray && i < n - 1; ++i) last -= f.w(3 * i);
  out.d_sum = out.d_square = ray ? static_cast<double>(n) : 1.0;
  return out;
}

/// Natural map and penetration without friction: min(r, u) of normal parts, r of tangential ones.
struct Exact {
  double residual, rate;
};
Exact without_friction(const GlobalForm& f, const std::vector<double>& r) {
  const Eigen::MatrixXd h(f.H);
  const Eigen::MatrixXd w = h.transpose() * Eigen::VectorXd(f.M.diagonal()).cwiseInverse().asDiagonal() * h;
  double square = 0.0, worst = 0.0, largest = 0.0;
  for (Eigen::Index i = 0; i < f.mu.size(); ++i) {
    ExactSum u;
    u.add(f.w(3 * i));
    for (Eigen::Index j = 0; j < w.cols(); ++j) {
      const double x = r[static_cast<std::size_t>(j)], product = w(3 * i, j) * x;
      u.add(product);
      u.add(std::fma(w(3 * i, j), x, -product));
    }
    const auto at = static_cast<std::size_t>(3 * i);
    const double map = std::min(r[at], u.value());
    square += map * map + r[at + 1] * r[at + 1] + r[at + 2] * r[at + 2];
    worst = std::max(worst, -u.value());
    largest = std::max(largest, f.w.segment<3>(3 * i).norm());
  }
  return {std::sqrt(square) / f.w.norm(), worst / largest};
}

}  // namespace

TEST_CASE("solve states the residual of what it returns where nothing solves: rays, zero rows, every solver",
          "[scenes][solve][lcp][long]") {
  const TemporaryFolder folder;
  Random random(71, 0);
  for (int draw = 0; draw < 12; ++draw) {
    const bool ray = draw % 2 == 0;
    const double friction = draw % 3 == 2 ? random.uniform(0.1, 0.9) : 0.0;
    const Unsolvable p = random_problem(random, ray, friction);
    const std::string path = (folder / ("p" + std::to_string(draw) + ".hdf5")).string();
    write_problem(path, p.form, "without solution");
    SolveOptions o;
    o.problems = {path};
    o.methods = {"all"};
    o.time_limit = "0.01s";
    o.json = true;
    o.solution = (folder / "r.h5").string();
    const Captured run = captured([&] { return command_solve(o); });
    CHECK(run.code == exit_bound);
    const FlatJson rows = flat_json(run.out);
    Hdf5File solution(o.solution, Hdf5File::Mode::read);
    double largest = 0.0;
    for (Eigen::Index i = 0; i < p.form.mu.size(); ++i) largest = std::max(largest, p.form.w.segment<3>(3 * i).norm());
    for (std::size_t k = 0; k < all_solvers().size(); ++k) {
      const std::string row = std::to_string(k) + ".", method = all_solvers()[k].entry.name;
      REQUIRE(rows.text(row + "method") == method);
      INFO("draw " << draw << ", " << method);
      CHECK(rows.text(row + "status") == "no_solution");
      CHECK_THAT(rows.text(row + "reason"), Catch::Contains(ray ? "ray: contacts" : "zero row: no impulse"));
      const double residual = rows.number(row + "residual").value_or(-1),
                   rate = rows.number(row + "penetration_rate").value_or(-1);
      CHECK(rate >= (1 - 1e-9) * p.closing / (p.d_sum * largest));  // d . u = -closing, whatever r
      if (friction > 0.0) continue;
      CHECK(residual >= (1 - 1e-9) * p.closing / (std::sqrt(p.d_square) * p.form.w.norm()));
      const auto r = solution.read<double>("p" + std::to_string(draw) + "/" + method + "/reaction");
      const Exact exact = without_friction(p.form, r);
      CHECK(residual == Approx(exact.residual).epsilon(1e-9));
      CHECK(rate == Approx(exact.rate).epsilon(1e-9));
    }
  }
}
