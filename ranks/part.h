/// @file part.h  The bodies of one rank, those of others that they may touch (ghosts), and all fixed and driven ones: a
/// simulation whose slots are in the order of all bodies, so that everything below it runs as it does for all of them.
/// Contacts across a border are found by both owners, from the same numbers.
/// All functions but the getters are called by all ranks together.
#pragma once
#include <cmath>
#include <optional>
#include <vector>

#include "engine/ranks/rank_team.h"
#include "engine/step/simulation.h"
#include "ranks/communicator.h"
#include "ranks/halo.h"
#include "ranks/part_figures.h"
#include "ranks/territory.h"

namespace epafi {

class Part {
 public:
  /// The simulation is of the same scene as the whole one; what it holds is thrown away.
  Part(Simulation& simulation, PartSetup setup)
      : sim_(simulation), stiffness_(setup.stiffness), territory_(std::move(setup)) {}

  /// The state of the whole, which only rank 0 has, is cut anew and shared out.
  void receive(Simulation* whole);
  /// The state of all parts comes into the whole.
  void give(Simulation* whole);
  /// Contacts of the last step, and where the bodies are: nothing else of the whole is of this moment.
  void give_contacts(Simulation* whole, bool in_pieces);
  /// Of all parts, at rank 0: as RemoteSteps has them.
  RemoteTotals totals(bool overlaps);
  double stiffness(double dt);
  /// One step; report: what all parts did in it. False where a body is astray.
  bool step(double dt, const std::optional<Domain>& domain, StepReport& report);
  PartFigures figures() const;
  /// For what others book of this rank's time.
  PartFigures& ledger() { return figures_; }

 private:
  void move(double longest);
  void settle(StateImage& image, const Arrival& arrival);
  void give_places(Simulation* whole);
  std::vector<std::byte> contact_rows(bool in_pieces);
  void put_contacts(const std::vector<std::byte>& rows, World& world, ContactSet& all) const;
  void note_overlaps();
  void sum_overlaps();
  bool is_sound(const std::optional<Domain>& domain) const;
  bool asks() const;

  /// Largest of the free bodies of all ranks.
  struct Motion {
    double way = 0.0;           ///< at most, since they were placed [m]
    double speed = 0.0;         ///< squared [m^2/s^2]
    double acceleration = 0.0;  ///< squared [m^2/s^4]
    /// In a step from now on, at most [m].
    double next(double dt) const { return dt * (std::sqrt(speed) + dt * std::sqrt(acceleration)); }
    double all(double dt) const { return way + next(dt); }
  };
  bool stays(double dt);
  Motion motion_of_own() const;
  double act_events(double dt);
  void join_held_loads();
  void begin_sums(bool sound);
  void finish_sums(StepReport& report, bool& sound);

  Simulation& sim_;
  decltype(PartSetup::stiffness) stiffness_;
  Territory territory_;
  Halo halo_;
  std::vector<std::uint32_t> place_;  ///< by slot: in the order of all bodies
  std::vector<Vec3> start_;           ///< by slot: where bodies were when they were placed [m]
  double own_ = 0.0;                  ///< free bodies of this rank
  bool prepared_ = false;             ///< events have seen this state where it was whole
  bool asked_ = false;                ///< some common event has something to do before the next step
  Motion motion_;
  std::optional<OverlapTotals> overlaps_;  ///< of the last step, once they are summed
  Joint joint_;
  WorkMeter work_;
  PartFigures figures_;
};

}  // namespace epafi
