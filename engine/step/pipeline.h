/// @file pipeline.h  The four stages of a step. One virtual call per stage and step, none per contact.
/// Every stage may keep data from step to step: it renames slots in `reorder` and shows its state in `visit`.
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "engine/state/contacts.h"
#include "engine/state/world.h"
#include "engine/step/report.h"

namespace epafi {

/// Base of all stages of a step.
class StepStage {
 public:
  virtual ~StepStage() = default;
  virtual const char* name() const = 0;
  /// Bodies moved to other slots or were removed.
  virtual void reorder(const Reordering&) {}
  /// State that must survive a restart for the same bits.
  virtual void visit(StateVisitor&) {}
};

/// Integrates the bodies: half before the forces are known, half after.
class Scheme : public StepStage {
 public:
  virtual void first_half(World& world, double dt) = 0;
  virtual void second_half(World& world, double dt) = 0;
  /// True if the halves exist for ranges of slots [begin, end). The first is then half a kick and the drift, the second
  /// half a kick, and a contact model may compute both itself.
  virtual bool has_ranges() const { return false; }
  virtual void first_half(World&, double, std::size_t, std::size_t) {}
  virtual void second_half(World&, double, std::size_t, std::size_t) {}
  virtual double velocity_lag() const { return 0.0; }
  /// The contact forces of time 0 must be known before the first step.
  virtual bool needs_initial_forces() const { return false; }
};

struct Extent;

/// No observer reads this step: its elastic energy and the loads of its contacts need not be told. Where events rest in
/// the next step, the contact model may do its first half too.
struct RunOn {
  std::function<bool(const Extent&)> agrees;  ///< whether the extent of the bodies in this step allows that
  bool bounded = true;                        ///< the next step needs the extent too, not only finite positions
  bool rests = true;                          ///< no event acts on a body before the next step
};

/// Impulses of springs within a step, by slot.
struct Pushes {
  std::vector<Vec3> linear;   ///< [N s]
  std::vector<Vec3> angular;  ///< world axes [N m s]; empty in worlds without rotation
};

/// Times of the step, for stages that compute forces or motion.
struct StepClock {
  double dt = 0.0;  ///< [s]
  double velocity_lag =
      0.0;  ///< world.velocity is that of time + (detection) - lag*dt: 1/2 for velocity Verlet, 0 otherwise
  Scheme* scheme = nullptr;  ///< the contact model calls its second half; null: the step does
  /// If given (all 0, by slot), only bodies with contacts get forces, and a 1 here; forces of the others are not
  /// written.
  std::vector<std::uint8_t>* touched = nullptr;
  const RunOn* run_on = nullptr;   ///< if given, nobody reads this step, and the next one has the same dt
  const Pushes* pushes = nullptr;  ///< if given, a model that changes velocities adds them as it adds gravity
};

/// Finds the pairs of bodies that may touch.
class BroadPhase : public StepStage {
 public:
  virtual void find_pairs(const World& world, PairList& pairs) = 0;
  /// True where the list of the last call is still valid by the positions alone.
  virtual bool keeps_pairs(const World&) { return false; }
};

/// Turns pairs into contacts in canonical order.
class NarrowPhase : public StepStage {
 public:
  virtual void collide(const World& world, const PairList& pairs, ContactSet& contacts) = 0;
  /// Removes contacts that a union of neighbouring surfaces would not have; called after all contacts are found.
  virtual void unite(const World&, ContactSet&) {}
};

/// Lets the contacts act. Smooth: writes world.force (and torque). Non-smooth: changes world.velocity (and angular
/// velocity) and includes gravity and external forces of the step. Writes contacts.force.
class ContactModel : public StepStage {
 public:
  /// Whether contacts of two bodies are wanted; empty: all are.
  using Wanted = std::function<bool(Slot a, Slot b)>;
  virtual void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) = 0;
  /// Adds the elastic energy of the present positions to report.elastic, for schemes without forces at the start.
  virtual void store(const World&, StepReport& /*report*/) {}
  /// Computes the first half of clock.scheme, and in `act` the second, in its own passes over the bodies while their
  /// data are in cache. False: the model computes neither.
  virtual bool move(World&, const StepClock&) { return false; }
  /// True after the first half of the next step: only the positions of the world are then up to date.
  virtual bool is_ahead() const { return false; }
  /// Extent of the bodies, if the model's passes measured it; else null.
  virtual const Extent* extent() const { return nullptr; }
  /// Adds the contacts that the model found itself to the set, for observers.
  virtual void publish(const World&, ContactSet&) const {}
  /// Number of groups ("parts") of contacts that the model found itself and that are not in the set.
  virtual std::size_t own_parts() const { return 0; }
  /// Number of contacts of a part if all of them touch; none if some only may (within the reach of adhesion).
  virtual std::optional<std::size_t> own_count(std::size_t /*part*/) const { return 0; }
  /// Appends bodies and gaps of a part, in an order that depends on the state alone; thread-safe.
  virtual void append_gaps(const World&, std::size_t /*part*/, ContactSet& /*gaps*/) const {}
  /// The same with feature, normal, arm and force, of the wanted ones.
  virtual void append_contacts(const World&, std::size_t /*part*/, const Wanted&, ContactSet& /*contacts*/) const {}
};

/// Continuous collision detection: stops bodies whose collisions detection at the end of a drift would miss.
class MotionGuard : public StepStage {
 public:
  /// Stores positions before bodies drift.
  virtual void remember(const World& world) = 0;
  /// Moves bodies back to their first contact after a drift of `duration` [s]. Returns the energy that this adds [J].
  virtual double hold_back(World& world, double duration) = 0;
};

struct Pipeline {
  std::unique_ptr<Scheme> scheme;
  std::unique_ptr<BroadPhase> broad_phase;
  std::unique_ptr<NarrowPhase> narrow_phase;
  std::unique_ptr<ContactModel> contact_model;
  std::unique_ptr<MotionGuard> guard = nullptr;  ///< null: no body is watched; with Moreau-Jean only

  template <class F>
  void each_stage(F&& f) {
    f(*scheme);
    f(*broad_phase);
    f(*narrow_phase);
    f(*contact_model);
    if (guard) f(*guard);
  }
};

}  // namespace epafi
