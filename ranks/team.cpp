#include "ranks/team.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "ranks/communicator.h"
#include "ranks/detection_part.h"
#include "ranks/orders.h"
#include "ranks/part.h"
#include "ranks/shared_detection.h"

namespace epafi {

namespace {

class Leader final : public RemoteSteps {
 public:
  Leader(std::shared_ptr<Simulation> part, PartSetup setup, bool& busy)
      : simulation_(std::move(part)), part_(*simulation_, std::move(setup)), busy_(busy) {}
  void send(Simulation& whole) override {
    const Busy busy(busy_);
    tell({.task = Task::receive});
    part_.receive(&whole);
  }
  void fetch(Simulation& whole, bool goes_on) override {
    const Busy busy(busy_);
    tell({.task = Task::give, .run_on = goes_on});
    part_.give(&whole, goes_on);
  }
  /// Once in a step, unless more contacts are wanted than came first.
  void fetch_seen(Simulation& whole, ContactView contacts) override {
    if (seen_ && *seen_ >= contacts) return;
    seen_ = contacts;
    const Busy busy(busy_);
    tell({.task = Task::give_seen, .contacts = contacts});
    part_.give_seen(&whole, contacts);
  }
  RemoteTotals totals(bool overlaps) override {
    const Busy busy(busy_);
    tell({.task = Task::totals, .code = overlaps ? 1 : 0});
    return part_.totals(overlaps);
  }
  double stiffness(double dt) override {
    const Busy busy(busy_);
    tell({.task = Task::stiffness, .dt = dt});
    return part_.stiffness(dt);
  }
  bool step(double dt, const std::optional<Domain>& domain, bool run_on, StepReport& report) override {
    const Busy busy(busy_);
    seen_.reset();
    Order order{.task = Task::step, .dt = dt, .run_on = run_on};
    order.set_domain(domain);
    tell(order);
    return part_.step(dt, domain, run_on, report);
  }
  bool is_ahead() const override { return simulation_->is_ahead(); }
  RankFigures figures() override {
    const Busy busy(busy_);
    tell({.task = Task::figures});
    return gather_figures(part_.figures());
  }

 private:
  std::shared_ptr<Simulation> simulation_;
  Part part_;
  bool& busy_;
  std::optional<ContactView> seen_;  ///< contacts of the last step that have come with its bodies
};

/// Text that rank 0 announces, sent after its order.
std::string announced(const Order& order) {
  std::string text(order.size, ' ');
  broadcast(text.data(), text.size());
  return text;
}

/// Waits for the next order, and books the time until it arrives.
Order await(PartFigures& figures) {
  RankTimer timer(figures);
  Order order;
  broadcast(&order, sizeof order);
  timer.lap(RankStage::orders);
  return order;
}

/// Obeys orders common to all kinds of parts; returns a value where the order ends their work.
template <class AnyPart>
std::optional<RankTeam::Followed> obey_any(const Order& order, AnyPart& part) {
  switch (order.task) {
    case Task::figures:
      gather_figures(part.figures());
      return std::nullopt;
    case Task::announce:
      return RankTeam::Followed{0, announced(order)};
    case Task::end:
      return RankTeam::Followed{order.code, {}};
    default:
      throw std::logic_error("an order for ranks of another kind");
  }
}

/// Obeys orders until the last one.
RankTeam::Followed obey(Part& part) {
  StepReport report;
  while (true) {
    const Order order = await(part.ledger());
    switch (order.task) {
      case Task::receive:
        part.receive(nullptr);
        break;
      case Task::give:
        part.give(nullptr, order.run_on);
        break;
      case Task::give_seen:
        part.give_seen(nullptr, order.contacts);
        break;
      case Task::totals:
        part.totals(order.code != 0);
        break;
      case Task::stiffness:
        part.stiffness(order.dt);
        break;
      case Task::step:
        part.step(order.dt, order.domain(), order.run_on, report);
        break;
      default:
        if (auto ended = obey_any(order, part)) return std::move(*ended);
    }
  }
}

RankTeam::Followed obey(DetectionPart& part, const PartSetup& setup, RankMessages& messages) {
  while (true) {
    const Order order = await(part.ledger());
    switch (order.task) {
      case Task::receive_to_find:
        part.receive(nullptr, nullptr, 0.0);
        break;
      case Task::find:
        part.find(nullptr, nullptr);
        break;
      case Task::give_found:
        part.give(nullptr);
        break;
      case Task::help:
        setup.help(messages);
        break;
      default:
        if (auto ended = obey_any(order, part)) return std::move(*ended);
    }
  }
}

constexpr int no_run = 1000;  ///< added to the code of a rank that ends before all have begun

/// Largest value over all ranks: 0, or no_run plus a code. Each rank calls it once.
int agree(int mine) {
  double largest = mine;
  max_over_ranks({&largest, 1});
  return static_cast<int>(largest);
}

}  // namespace

int MpiTeam::count() const { return rank_count(); }
int MpiTeam::number() const { return rank_number(); }

void MpiTeam::lead(Simulation& whole, std::shared_ptr<Simulation> part, PartSetup setup) {
  agreed_ = true;
  const int all = agree(0);
  if (all != 0) {
    agreed_ = following_ = true;  // no rank is left to inform
    throw FileError("another process of the run could not begin: it ended with code " + std::to_string(all - no_run));
  }
  if (setup.shares == PartSetup::Shares::contacts) {
    helped_ = static_cast<bool>(setup.help) && rank_count() > 1;
    figures_ = share_detection(whole, std::move(part), std::move(setup), busy_);
  } else {
    whole.remote = std::make_unique<Leader>(std::move(part), std::move(setup), busy_);
    figures_ = [steps = whole.remote.get()] { return steps->figures(); };
  }
}

void MpiTeam::announce(const std::string& text) {
  const Busy busy(busy_);
  tell({.task = Task::announce, .size = text.size()});
  std::string sent = text;
  broadcast(sent.data(), sent.size());
  agreed_ = helped_ = false;
  figures_ = nullptr;
}

std::optional<RankFigures> MpiTeam::figures() {
  if (!figures_) return std::nullopt;
  return figures_();
}

RankTeam::Followed MpiTeam::follow(Simulation& part, PartSetup setup) {
  agreed_ = true;
  if (const int all = agree(0); all != 0) return {all - no_run, {}};
  following_ = true;
  Followed end;
  if (setup.shares == PartSetup::Shares::contacts) {
    DetectionPart finder(part, setup);
    with_team([&] { end = obey(finder, setup, messages_); });
  } else {
    Part mine(part, std::move(setup));
    with_team([&] { end = obey(mine); });
  }
  following_ = false;
  agreed_ = end.announced.empty();
  return end;
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
