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

/// What all stages share.
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
  /// The same for the bodies of slots [begin, end) alone, where has_ranges: the first is then half a kick and the
  /// drift, the second half a kick, and a contact model may do both itself.
  virtual bool has_ranges() const { return false; }
  virtual void first_half(World&, double, std::size_t, std::size_t) {}
  virtual void second_half(World&, double, std::size_t, std::size_t) {}
  virtual double velocity_lag() const { return 0.0; }
  /// The contact forces of time 0 must be known before the first step.
  virtual bool needs_initial_forces() const { return false; }
};

struct Extent;

/// Permission for the contact model to do the first half of the next step too. No observer reads this step, so the
/// energy stored in its contacts need not be reported.
struct RunOn {
  std::function<bool(const Extent&)> agrees;  ///< to where the bodies are in this step
  bool bounded = true;  ///< it will ask where they are in the next one, not only whether somewhere
};

/// Impulses that act within a step beside gravity, external forces and contacts: those of springs. By slot.
struct Pushes {
  std::vector<Vec3> linear;   ///< [N s]
  std::vector<Vec3> angular;  ///< world axes [N m s]; empty in worlds without rotation
};

/// What a stage that acts needs to know about the step.
struct StepClock {
  double dt = 0.0;  ///< [s]
  double velocity_lag =
      0.0;  ///< world.velocity is that of time + (detection) - lag*dt: 1/2 for velocity Verlet, 0 otherwise
  Scheme* scheme = nullptr;  ///< whose second half the contact model calls; null: the step calls it
  /// Where it is given, all 0 by slot, only the bodies of contacts get their forces, and a 1 here; those of others are
  /// left as they are.
  std::vector<std::uint8_t>* touched = nullptr;
  const RunOn* run_on = nullptr;   ///< where it is given, the next step has the same dt
  const Pushes* pushes = nullptr;  ///< where given, a model that changes velocities adds them as it adds gravity
};

/// Finds the pairs of bodies that may touch.
class BroadPhase : public StepStage {
 public:
  virtual void find_pairs(const World& world, PairList& pairs) = 0;
  /// From positions alone: whether the list of the last call is still valid.
  virtual bool keeps_pairs(const World&) { return false; }
};

/// Turns pairs into contacts in canonical order.
class NarrowPhase : public StepStage {
 public:
  virtual void collide(const World& world, const PairList& pairs, ContactSet& contacts) = 0;
  /// Removes contacts that neighbouring surfaces rule out; called when all contacts have been found.
  virtual void unite(const World&, ContactSet&) {}
};

/// Lets the contacts act. Smooth: writes world.force (and torque). Non-smooth: changes world.velocity (and angular
/// velocity) and includes gravity and external forces of the step. Writes contacts.force.
class ContactModel : public StepStage {
 public:
  virtual void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) = 0;
  /// Adds the energy stored in the present positions to report.elastic, where no forces are evaluated at the start.
  virtual void store(const World&, StepReport& /*report*/) {}
  /// Runs the first half of clock.scheme, and in `act` its second, within its own passes over the bodies, while their
  /// data are in cache. False: the model does neither.
  virtual bool move(World&, const StepClock&) { return false; }
  /// The first half of the next step is done: of the world only the positions are up to date.
  virtual bool is_ahead() const { return false; }
  /// Extent of the bodies as the model's passes found it; null: not measured.
  virtual const Extent* extent() const { return nullptr; }
  /// Completes the set for observers where the model has found contacts of its own.
  virtual void publish(const World&, ContactSet&) const {}
  /// Number of parts of the contacts that the model has found itself and that are not in the set.
  virtual std::size_t own_parts() const { return 0; }
  /// Contacts of a part where all of them touch; nothing where it lists some that only may (within reach of adhesion).
  virtual std::optional<std::size_t> own_count(std::size_t /*part*/) const { return 0; }
  /// Appends bodies and gaps of a part, in an order that depends on the state alone; thread-safe.
  virtual void append_gaps(const World&, std::size_t /*part*/, ContactSet& /*gaps*/) const {}
  /// The same with feature, normal, arm and force.
  virtual void append_contacts(const World&, std::size_t /*part*/, ContactSet& /*contacts*/) const {}
};

/// Stops bodies on paths whose collisions the detection at the end of a drift would miss. Only for `continuous` bodies.
class MotionGuard : public StepStage {
 public:
  /// Before bodies drift.
  virtual void remember(const World& world) = 0;
  /// After they drifted for `duration` [s]. Returns the energy that the bodies gained by being held back [J].
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
