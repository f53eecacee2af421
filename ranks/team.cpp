#include "ranks/team.h"

#include <algorithm>
#include <exception>
#include <string>
#include <type_traits>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "ranks/communicator.h"
#include "ranks/part.h"

namespace epafi {

namespace {

enum class Task : std::int32_t { receive, give, give_contacts, step, figures, end };

/// As it is sent to all.
struct Order {
  Task task = Task::end;
  std::int32_t code = 0;  ///< to end with
  double dt = 0.0;        ///< [s]
  double low[3] = {}, high[3] = {};
  std::int32_t has_domain = 0, outside = 0;

  void set_domain(const std::optional<Domain>& domain) {
    has_domain = domain.has_value();
    if (!domain) return;
    for (int k = 0; k < 3; ++k) {
      low[k] = domain->min[k];
      high[k] = domain->max[k];
    }
    outside = static_cast<std::int32_t>(domain->outside);
  }
  std::optional<Domain> domain() const {
    if (has_domain == 0) return std::nullopt;
    return Domain{Vec3(low[0], low[1], low[2]), Vec3(high[0], high[1], high[2]), static_cast<Domain::Outside>(outside)};
  }
};
static_assert(std::is_trivially_copyable_v<Order>);

void tell(Order order) { broadcast(&order, sizeof order); }

RankFigures gather_figures(const PartFigures& mine) {
  RankFigures all;
  all.ranks = rank_count();
  const double steps = std::max(1.0, mine.steps);
  double sums[3] = {mine.own / steps, mine.ghosts / steps, mine.bytes}, most = mine.own / steps;
  sum_over_ranks(sums);
  max_over_ranks({&most, 1});
  all.imbalance = sums[0] > 0.0 ? most * all.ranks / sums[0] : 1.0;
  all.ghosts = sums[0] > 0.0 ? sums[1] / sums[0] : 0.0;
  all.bytes_per_step = sums[2] / steps;
  all.moves = mine.moved;
  return all;
}

/// True while it lives, and for ever where it is left by an exception.
class Busy {
 public:
  explicit Busy(bool& busy) : busy_(busy), exceptions_(std::uncaught_exceptions()) { busy_ = true; }
  ~Busy() { busy_ = std::uncaught_exceptions() > exceptions_; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  bool& busy_;
  int exceptions_;
};

class Leader final : public RemoteSteps {
 public:
  Leader(std::shared_ptr<Simulation> part, PartSetup setup, bool& busy)
      : simulation_(std::move(part)), part_(*simulation_, std::move(setup)), busy_(busy) {}
  void send(Simulation& whole) override {
    const Busy busy(busy_);
    tell({.task = Task::receive});
    part_.receive(&whole);
  }
  void fetch(Simulation& whole) override {
    const Busy busy(busy_);
    tell({.task = Task::give});
    part_.give(&whole);
  }
  void fetch_contacts(Simulation& whole) override {
    const Busy busy(busy_);
    tell({.task = Task::give_contacts});
    part_.give_contacts(&whole);
  }
  bool step(double dt, const std::optional<Domain>& domain, StepReport& report) override {
    const Busy busy(busy_);
    Order order{.task = Task::step, .dt = dt};
    order.set_domain(domain);
    tell(order);
    return part_.step(dt, domain, report);
  }
  RankFigures figures() override {
    const Busy busy(busy_);
    tell({.task = Task::figures});
    return gather_figures(part_.figures());
  }

 private:
  std::shared_ptr<Simulation> simulation_;
  Part part_;
  bool& busy_;
};

/// One order after the other, until the last one.
int obey(Part& part) {
  StepReport report;
  while (true) {
    Order order;
    broadcast(&order, sizeof order);
    switch (order.task) {
      case Task::receive:
        part.receive(nullptr);
        break;
      case Task::give:
        part.give(nullptr);
        break;
      case Task::give_contacts:
        part.give_contacts(nullptr);
        break;
      case Task::step:
        part.step(order.dt, order.domain(), report);
        break;
      case Task::figures:
        gather_figures(part.figures());
        break;
      case Task::end:
        return order.code;
    }
  }
}

constexpr int no_run = 1000;  ///< added to the code of a rank that ends before all have begun

/// The largest of what all ranks say, each once: 0 or no_run and a code.
int agree(int mine) {
  double largest = mine;
  max_over_ranks({&largest, 1});
  return static_cast<int>(largest);
}

}  // namespace

int MpiTeam::count() const { return rank_count(); }
int MpiTeam::number() const { return rank_number(); }

std::unique_ptr<RemoteSteps> MpiTeam::lead(std::shared_ptr<Simulation> part, PartSetup setup) {
  agreed_ = true;
  const int all = agree(0);
  if (all != 0) {
    agreed_ = following_ = true;  // nobody is left to be told
    throw FileError("another process of the run could not begin: it ended with code " + std::to_string(all - no_run));
  }
  return std::make_unique<Leader>(std::move(part), std::move(setup), busy_);
}

int MpiTeam::follow(Simulation& simulation, PartSetup setup) {
  agreed_ = true;
  if (const int all = agree(0); all != 0) return all - no_run;
  following_ = true;
  Part part(simulation, std::move(setup));
  int code = 0;
  with_team([&] { code = obey(part); });
  following_ = false;
  return code;
}

bool MpiTeam::end(int code) {
  code_ = code;
  if (!agreed_) {
    code_ = std::max(code, agree(no_run + code) - no_run);
    return true;
  }
  if (rank_number() != 0) return !following_;
  if (following_) return true;
  if (busy_) return false;
  tell({.task = Task::end, .code = code});
  return true;
}

}  // namespace epafi
