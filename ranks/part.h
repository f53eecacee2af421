/// @file part.h  The bodies of one rank, those of others that they may touch (ghosts), and all fixed and driven ones: a
/// simulation whose slots are in the order of all bodies, so that everything below it runs as it does for all of them.
/// Contacts across a border are found by both owners, from the same numbers.
/// All functions but the getters are called by all ranks together.
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "engine/ranks/rank_team.h"
#include "engine/ranks/shared_list.h"
#include "engine/ranks/shared_model.h"
#include "engine/step/simulation.h"
#include "ranks/communicator.h"
#include "ranks/halo.h"
#include "ranks/part_figures.h"
#include "ranks/territory.h"

namespace epafi {

class Part {
 public:
  /// simulation: of the same scene as the whole one; its bodies are discarded.
  Part(Simulation& simulation, PartSetup setup)
      : sim_(simulation),
        stiffness_(setup.stiffness),
        deforms_(setup.deforms),
        only_spheres_(setup.only_spheres),
        tied_(setup.tied),
        territory_(std::move(setup)) {}

  /// Distributes the state of the whole, which only rank 0 has, by new cuts.
  void receive(Simulation* whole);
  /// Gathers the state of all parts in the whole; goes_on: as RemoteSteps::fetch.
  void give(Simulation* whole, bool goes_on);
  /// As RemoteSteps::fetch_seen.
  void give_seen(Simulation* whole, ContactView contacts);
  /// Of all parts, at rank 0: as RemoteSteps has them.
  RemoteTotals totals(bool overlaps);
  double stiffness(double dt);
  /// One step; report: sums over all parts. False if a body is outside the domain or not finite. run_on: as
  /// RemoteSteps::step.
  bool step(double dt, const std::optional<Domain>& domain, bool run_on, StepReport& report);
  PartFigures figures() const;
  /// Timer of this rank, for work that other code books.
  PartFigures& ledger() { return figures_; }

 private:
  void move(double longest);
  bool hold(double dt);
  void settle(StateImage& image, const Arrival& arrival, bool begun);
  /// The next step, and what contacts read of its bodies is in their states.
  bool has_begun() const { return by_states_ && sim_.is_ahead(); }
  void give_bodies(Simulation* whole);
  void give_contacts(Simulation* whole, bool in_pieces);
  RowBytes contact_rows() const;
  void put_contacts(const RowBytes& rows, bool in_pieces, const World& world, ContactSet& all) const;
  void note_overlaps();
  void sum_overlaps();
  bool is_sound(const std::optional<Domain>& domain) const;
  bool asks() const;

  /// Of the free bodies of all ranks. What they do together takes none nearer to another one, as where all fall: ways
  /// and speeds are those beside it, along the axes that are cut.
  struct Motion {
    double way = 0.0;                              ///< largest displacement since they were placed [m]
    Vec3 together = Vec3::Zero();                  ///< common displacement since then [m]
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< of their velocities [m/s]
    double acceleration = 0.0;                     ///< largest, squared [m^2/s^4]
    Vec3 along = Vec3::Ones();                     ///< as Territory::cut_axes
    Vec3 velocity() const { return 0.5 * (low + high); }
    /// In a step from now on, at most [m].
    double next(double dt) const {
      return dt * (0.5 * along.cwiseProduct(high - low).maxCoeff() + dt * along.maxCoeff() * std::sqrt(acceleration));
    }
    double all(double dt) const { return way + next(dt); }
    void go(double dt) {
      way += next(dt);
      together += dt * velocity();
    }
  };
  bool stays(double dt);
  double farthest_of_own() const;
  void note_flow(double dt);
  /// Largest velocities along each axis, then against it [m/s]; largest square of an acceleration [m^2/s^4].
  using Speeds = std::array<double, 7>;
  Speeds speeds_of_own() const;
  Speeds speeds_of(const Extent& begun) const;
  void take_speeds(std::span<const double> largest);
  double act_events(double dt);
  SharedList* shared_list() const { return dynamic_cast<SharedList*>(sim_.pipeline.broad_phase.get()); }
  SharedModel* shared_model() const { return dynamic_cast<SharedModel*>(sim_.pipeline.contact_model.get()); }
  void join_held_loads();
  void take_off_held_pulls();
  void join_virial();
  bool may_run_on(const std::optional<Domain>& domain) const;
  void begin_sums(bool sound, const std::optional<Domain>& domain);
  void finish_sums(StepReport& report, bool& sound);

  Simulation& sim_;
  decltype(PartSetup::stiffness) stiffness_;
  bool deforms_, only_spheres_;
  bool by_states_ = false;  ///< forces need not go to other ranks where the next step has begun
  decltype(PartSetup::tied) tied_;
  Territory territory_;
  Halo halo_;
  std::vector<std::uint32_t> place_;  ///< by slot: in the order of all bodies
  /// Positions of bodies when they were placed, by slot, and the cell then.
  struct Start {
    std::vector<Vec3> position;  ///< [m]
    std::vector<Wraps> wraps;    ///< in a periodic cell
    Vec3 cell = Vec3::Ones();    ///< its size [m]
    double grown = 1.0;          ///< largest factor by which the cell's flow has reduced distances since
  } start_;
  double own_ = 0.0;                     ///< free bodies of this rank
  double all_ = 0.0, all_ghosts_ = 0.0;  ///< free bodies and ghosts of all ranks
  bool prepared_ = false;                ///< events have seen this state where it was whole
  bool asked_ = false;                   ///< some common event has something to do before the next step
  bool settled_ = false;                 ///< bodies have come since the last step
  bool list_ends_ = false;               ///< some rank makes a new pair list in the next step
  bool is_uneven_ = false;               ///< new cuts are worth a move
  double worked_ = 0.0;                  ///< by all ranks since the last cuts [s]
  /// Where the next step has begun: all bodies are numbers in it, and inside the domain if the last one had that.
  bool inside_ = false, had_domain_ = false;
  Motion motion_;
  double dt_ = 0.0;                        ///< of the last step [s]; 0: there was none
  std::optional<OverlapTotals> overlaps_;  ///< of the last step, once they are summed
  std::optional<RowBytes> told_;           ///< contacts of the last step, once the model has given its memory away
  bool virial_is_joined_ = true;           ///< the cell has that of the last step, of all contacts
  Joint joint_;
  WorkMeter work_;
  PartFigures figures_;
};

}  // namespace epafi
