/// @file simulation.h  A running scene: world, stages, events, ledger, observers, and the walk over all their state.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "engine/ranks/remote_steps.h"
#include "engine/step/domain.h"
#include "engine/step/energy.h"
#include "engine/step/events.h"
#include "engine/step/loads.h"
#include "engine/step/observer.h"
#include "engine/step/step.h"
#include "engine/step/step_watch.h"
#include "engine/step/warnings.h"

namespace epafi {

class Simulation {
 public:
  Simulation(World w, Pipeline p, double dt) : world(std::move(w)), pipeline(std::move(p)), time_step(dt) {}

  World world;
  Pipeline pipeline;
  Workspace work;
  EnergyLedger ledger;
  Warnings warnings;  ///< troubles that do not end the run
  std::optional<Domain> domain;
  std::vector<std::unique_ptr<Event>> events;
  std::unique_ptr<Loads> loads;  ///< time-dependent gravity, forces and torques; null: none
  std::vector<std::unique_ptr<Observer>> observers;
  std::unique_ptr<RemoteSteps> remote;  ///< makes the steps in several processes; null: one process
  double time_step;                     ///< dt [s]
  /// Number of substeps that the time step is divided into now, >= 1; empty: one.
  std::function<int(const World&)> parts_of_step;
  std::unique_ptr<StepWatch> step_watch;  ///< null: the stability of the step is not watched
  std::uint64_t sort_interval =
      1000;  ///< steps between Morton sorts; 100 to 10 000: same time within 2 %; never: 1.25 to 1.6 times
  /// Steps between removals of bodies outside a domain with `outside = "delete"`. A removal reorders all columns, pairs
  /// and springs, which costs as much as ten steps of 20 000 spheres (in a flowing hopper an interval of 20 makes the
  /// run 1.5 times as long). Steps of non-smooth contact are a hundred times longer.
  std::uint64_t outlet_interval() const { return pipeline.scheme->needs_initial_forces() ? 100 : 20; }

  std::uint64_t steps() const { return steps_; }
  /// Evaluations of the forces: more than steps where a time step is divided.
  std::uint64_t parts_made() const { return parts_made_; }
  std::uint64_t bodies_removed() const { return removed_; }  ///< by remove_at, outlets and `outside = "delete"`

  /// Computes initial forces, starts the ledger, calls observers for step 0.
  void start();
  /// How to continue from the state of another simulation that was loaded into this one.
  struct Entry {
    bool forces_hold = false;  ///< the stored contact forces are those of this scene
    bool new_ledger = false;   ///< the ledger starts anew; else the jump of the stored energy counts as work
    double stored_before = 0;  ///< stored energy in the other ledger at this time [J]
    double elastic = 0;        ///< elastic energy of its contacts [J]
  };
  void enter(const Entry& entry);
  /// Sets the steps made here and, before, by another simulation: sorts keep their interval.
  void continue_at(std::uint64_t steps, std::uint64_t before) {
    steps_ = steps;
    before_ = before;
  }
  std::uint64_t steps_before() const { return before_; }
  /// Bodies to remove before the next step.
  const std::vector<BodyId>& leaving() const { return leaving_; }
  void take_leaving(std::vector<BodyId> bodies) { leaving_ = std::move(bodies); }
  /// Counts bodies that another simulation removed.
  void add_removed(std::uint64_t bodies) { removed_ += bodies; }
  /// One step with events and observers. last: observers see the end of the run. run_on: only observers read the bodies
  /// before the next call, and that has the same time step; the contact model may then do its first half at once (saves
  /// 10 of 57 ns of a sphere in a bed). On a failure the state remains for the caller to save.
  std::optional<Failure> advance(bool last = false, bool run_on = false);
  /// Power of servo walls on all other bodies, with the forces of the last step [W].
  double held_power() const;
  /// A failure if the ledger's energy is not finite (velocities may be).
  std::optional<Failure> check_energy();
  /// True if the last call has begun the next step: bodies must not be read then.
  bool is_ahead() const { return remote ? remote->is_ahead() : pipeline.contact_model->is_ahead(); }
  /// With several processes: gathers the present state here. Call it before bodies are read.
  void gather_state();
  /// Sums over the bodies of all processes.
  BodyTotals totals();
  /// Measures the energies of the present state for the ledger.
  void measure() { ledger.measure(totals()); }
  /// Shows one observer the present state, due or not.
  void show(Observer& observer);
  /// All state that a restart needs for the same bits.
  void visit(StateVisitor& visitor);

 private:
  void sort_bodies();
  void count_movable();
  void take_out();
  void welcome(std::size_t before);
  std::optional<Failure> make_step(double dt, bool sort, bool run_on, StageTimer& timer);
  std::optional<Failure> make_remote_step(double dt, bool sort, bool run_on, StageTimer& timer);
  void prepare(double dt, bool sort);
  bool is_unobserved() const;
  bool sorts_now() const { return steps_ + before_ > 0 && (steps_ + before_) % sort_interval == 0; }
  const std::optional<Domain>& watched() const;
  std::optional<Failure> check_positions();
  void drop_contacts();
  std::optional<Failure> watch();
  bool step_is_watched();
  void observe(bool last, bool watched);
  std::optional<Failure> check_step();
  void show_contacts(ContactView needed, bool last, const std::function<void(const StepView&)>& show);
  void reorder(const Reordering& change);

  std::uint64_t steps_ = 0;
  std::uint64_t before_ = 0;  ///< steps of a run that this one began from
  std::uint64_t removed_ = 0;
  std::size_t movable_ = 0;                ///< free bodies
  std::uint64_t parts_made_ = 0;           ///< of all time steps
  BodyTotals totals_;                      ///< as last measured, for observers
  std::optional<OverlapTotals> overlaps_;  ///< of overlaps of contacts in other processes
  std::vector<BodyId> leaving_;            ///< to remove before the next step; observers see them until then
  /// Location of the state in runs of several processes.
  struct Away {
    bool home = true;      ///< the present state is here
    bool sent = false;     ///< it is in the other processes too, or only there
    bool stepped = false;  ///< the contacts of the last detection are there
    bool rest = false;     ///< no event but local ones acts before the next step of length dt
    double dt = 0.0;       ///< [s]
  } away_;
};

}  // namespace epafi
