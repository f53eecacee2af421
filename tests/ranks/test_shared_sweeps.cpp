// Sweeps of random problems by all ranks: impulses, number of sweeps and residual of one process, to the bit.
#include <cmath>

#include "engine/ranks/rank_team.h"
#include "laws/nonsmooth/shared_sweeps.h"
#include "laws/nonsmooth/solvers/gauss_seidel.h"
#include "ranks/communicator.h"
#include "ranks/mpi_messages.h"
#include "ranks/orders.h"
#include "tests/support/catch.h"
#include "tests/support/contact_worlds.h"

using namespace epafi;

namespace {

constexpr int draws = 25;

/// Nothing but the messages of sweeps, counted.
class Helped final : public RankTeam {
 public:
  Helped() : messages_(busy_) { messages_.least_contacts = 0; }
  int count() const override { return rank_count(); }
  int number() const override { return rank_number(); }
  void lead(Simulation&, std::shared_ptr<Simulation>, PartSetup) override {}
  void announce(const std::string&) override {}
  Followed follow(Simulation&, PartSetup) override { return {}; }
  std::optional<RankFigures> figures() override { return std::nullopt; }
  RankMessages* helpers() override {
    ++asked;
    return &messages_;
  }
  int asked = 0;

 private:
  bool busy_ = false;
  MpiMessages messages_;
};

/// As a rank that rank 0 asks for help.
void help() {
  bool busy = false;
  MpiMessages messages(busy);
  for (int k = 0; k < draws; ++k) {
    Order order;
    broadcast(&order, sizeof order);
    REQUIRE(order.task == Task::help);
    help_with_sweeps(messages);
  }
}

struct Solved {
  Impulses r;
  SolverReport report;
};

Solved solve(const ContactProblem& problem, const Impulses& start, const Parameters& parameters, double relaxation) {
  GaussSeidel<PgsRule> solver(PgsRule{relaxation}, parameters);
  Solved out{start, {}};
  out.report = solver.solve(problem, out.r);
  return out;
}

}  // namespace

TEST_CASE("sweeps of random problems by all ranks are those of one process to the bit") {
  if (rank_number() != 0) return help();
  Helped team;
  int early = 0;
  for (int draw = 0; draw < draws; ++draw) {
    Random random(17, static_cast<std::uint64_t>(draw));
    const int size = static_cast<int>(random.uniform(0, 100));
    const double mu = random.uniform(0, 1);
    ContactProblem problem = draw % 5 < 2 ? test::lattice_problem(2 + size / 30, mu, 1 + draw % 4)
                                          : test::random_problem(2 + size, random.bits(), draw % 3 != 0, mu);
    const auto vec = [&](double s) {
      return Vec3(random.uniform(-s, s), random.uniform(-s, s), random.uniform(-s, s));
    };
    if (draw % 5 > 2) {
      problem.lag.resize(problem.size());
      for (Vec3& w : problem.lag) w = Vec3(0, random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
    }
    if (problem.size() > 4) problem.leave_out(3);
    Impulses start(problem.size());
    for (Vec3& r : start) r = draw % 4 == 0 ? Vec3(Vec3::Zero()) : vec(0.1);
    Parameters parameters;
    parameters.set("iterations", 1.0 + std::floor(random.uniform(0, 120)));
    parameters.set("tolerance", std::pow(10.0, random.uniform(-6, -1.5)));
    const double relaxation = random.uniform(0.6, 1.4);
    const Solved alone = solve(problem, start, parameters, relaxation);
    RankTeam::set_of_program(&team);
    const Solved shared = solve(problem, start, parameters, relaxation);
    RankTeam::set_of_program(nullptr);
    INFO("draw " << draw << ", " << problem.size() << " contacts");
    CHECK(shared.r == alone.r);
    CHECK(shared.report.iterations == alone.report.iterations);
    CHECK(shared.report.residual == alone.report.residual);
    CHECK(shared.report.converged == alone.report.converged);
    early += alone.report.converged;
  }
  CHECK(team.asked == draws);
  CHECK(early > 0);  // some draw ends by its tolerance
}
