/// @file observer.h  Observers of finished steps: measures, files, ledgers of overlap. Const access only, so output
/// cannot change a trajectory.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "engine/step/contact_pieces.h"
#include "engine/step/energy.h"

namespace epafi {

/// A finished step. Contacts are those of the last detection.
struct StepView {
  const World& world;
  const ContactSet& contacts;
  const PairList& pairs;
  const StepReport& report;
  const EnergyLedger& ledger;
  std::uint64_t step = 0;                   ///< steps done so far
  double dt = 0.0;                          ///< [s]
  std::size_t movable = 0;                  ///< free bodies now
  bool last = false;                        ///< the run ends with this step
  const ContactModel* model = nullptr;      ///< with contacts of its own; null: none
  const BodyTotals* bodies = nullptr;       ///< of this moment; null: `world` has the bodies
  const OverlapTotals* overlaps = nullptr;  ///< of this moment, where contacts may be elsewhere; null: they are here

  /// All contacts, including those that are not in `contacts`.
  ContactPieces pieces() const { return {world, contacts, model}; }
  BodyTotals totals() const { return bodies != nullptr ? *bodies : body_totals(world); }
};

/// Contacts that an observer reads: none, sums over overlaps (StepView::overlaps, or else pieces), single ones in
/// StepView::pieces, or all in `contacts`.
enum class ContactView { none, overlaps, pieces, all };

/// Called when `is_due`; the simulation measures the energies before if `wants_energy`.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual bool is_due(std::uint64_t step) const = 0;
  virtual bool wants_energy(std::uint64_t /*step*/) const { return false; }
  /// True if it reads single bodies in this step; several processes then gather them. If no observer reads bodies or
  /// energies, the next step may begin before observers see this one.
  virtual bool wants_bodies(std::uint64_t step) const { return is_due(step); }
  /// Contacts that it reads in this step (last: the last of the run). A contact model with contacts of its own writes
  /// only what observers read, in pieces if that is enough.
  virtual ContactView wants_contacts(std::uint64_t step, bool last) const {
    return last || is_due(step) ? ContactView::all : ContactView::none;
  }
  virtual void observe(const StepView& view) = 0;
  /// Called between two steps: the bodies from slot `first` on have entered at their present positions.
  virtual void bodies_come(const World& /*world*/, std::size_t /*first*/) {}
  /// Called between two steps, before these bodies are removed.
  virtual void bodies_leave(const World& /*world*/, std::span<const BodyId> /*bodies*/) {}
  virtual void visit(StateVisitor&) {}
};

/// Due in the steps nearest to the multiples of an interval, and at step 0: always within half a step of k times the
/// interval.
class EverySteps {
 public:
  EverySteps() = default;
  /// every: the interval in steps, not necessarily whole; below 1 every step is due.
  EverySteps(double every, std::uint64_t first = 0) : every_(std::max(1.0, every)), first_(first) {}
  /// interval [s], 0: every step; dt [s]; first: the step that it is counted from
  static EverySteps of_time(double interval, double dt, std::uint64_t first = 0) {
    return EverySteps(interval / dt, first);
  }
  bool is_due(std::uint64_t step) const {
    const auto now = static_cast<double>(step) - static_cast<double>(first_);
    return std::round(std::round(now / every_) * every_) == now;
  }

 private:
  double every_ = 1.0;
  std::uint64_t first_ = 0;
};

}  // namespace epafi
