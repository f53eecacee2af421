/// @file world.h  The state of all bodies: one column per quantity, structure of arrays, indexed by slot.
/// A column that the scene does not need is empty (see Columns). Fixed and driven bodies have inverse mass 0.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/state/large_column.h"
#include "engine/state/periodic_cell.h"
#include "engine/state/rotation.h"
#include "engine/state/state_column.h"
#include "engine/state/state_visitor.h"
#include "engine/state/types.h"

namespace epafi {

/// Which optional columns exist; the plan of the scene decides.
struct Columns {
  bool rotation = false;         ///< angular velocity, inverse inertia
  bool orientation = true;       ///< with rotation; without it bodies keep the orientation of the scene
  bool free_turn = true;         ///< with orientation: free bodies rotate with their spin; not needed for spheres
  bool anisotropy = false;       ///< some free body has unequal principal moments: angular momentum is stored too
  bool force = true;             ///< force (and torque, with rotation): smooth contact only
  bool external_force = false;   ///< forces from outside on some bodies
  bool external_torque = false;  ///< and torques: with rotation
  bool loose_force = false;      ///< with external_force: some depend on time
  bool periodic = false;         ///< cells passed by each body
  bool held_force = false;       ///< contact forces on fixed and driven bodies are summed too
  bool states = false;           ///< one BodyState per body holds position, velocities and inertia
};

/// One body as it enters the world.
struct Body {
  Vec3 position = Vec3::Zero();          ///< centre of mass [m]
  Quat orientation = Quat(1, 0, 0, 0);   ///< principal axes to world
  Vec3 velocity = Vec3::Zero();          ///< [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< world axes [rad/s]
  double mass = 0.0;                     ///< [kg]; 0: fixed or driven
  Vec3 inertia = Vec3::Zero();           ///< principal moments [kg m^2]; unused where mass is 0
  Vec3 external_force = Vec3::Zero();    ///< [N]
  std::uint32_t shape = 0;               ///< opaque to the engine: packed type and index of detection/shape_store.h
  std::uint16_t material = 0;
};

/// New slot of every body: new_slot[old], no_slot for a removed body. Stages renumber the data that they keep.
struct Reordering {
  std::vector<Slot> new_slot;
};

class World {
 public:
  explicit World(Columns columns = {}) : columns_(columns) { place_states(); }
  World(const World&) = delete;
  World(World&&) = default;
  World& operator=(const World&) = delete;
  World& operator=(World&&) = default;
  ~World() = default;

  double time = 0.0;                   ///< [s]
  double clock = 0.0;                  ///< time since the start of the present stage [s]
  Vec3 gravity = Vec3::Zero();         ///< [m/s^2]
  Vec3 loose_gravity = Vec3::Zero();   ///< the time-dependent part of it, without potential [m/s^2]
  Vec3 fallen = Vec3::Zero();          ///< integral of gravity over time [m/s]
  std::optional<PeriodicCell> cell{};  ///< periodic cell; with columns().periodic

  std::vector<BodyId> id;  ///< of each slot
  std::vector<std::uint32_t> shape;
  std::vector<std::uint16_t> material;
  StateColumn<double> inverse_mass;    ///< [1/kg], 0 for fixed and driven bodies
  StateColumn<Vec3> position;          ///< [m]
  StateColumn<Vec3> velocity;          ///< [m/s]
  std::vector<Wraps> wraps;            ///< cells passed; with columns().periodic
  std::vector<Vec3> force;             ///< contact force at the last detection [N]; with columns().force
  std::vector<Vec3> external_force;    ///< [N]; with columns().external_force
  std::vector<Vec3> external_torque;   ///< world axes [N m]; with columns().external_torque
  std::vector<Vec3> loose_force;       ///< time-dependent part of the external force [N]; with columns().loose_force
  std::vector<Quat> orientation;       ///< with columns().rotation and columns().orientation
  StateColumn<Vec3> angular_velocity;  ///< world axes [rad/s]; with columns().rotation, as are the next ones
  std::vector<Vec3> inverse_inertia;   ///< principal axes [1/(kg m^2)]; with columns().anisotropy, else the next one
  StateColumn<double> inverse_moment;  ///< of bodies with equal principal moments [1/(kg m^2)]
  std::vector<Vec3> torque;            ///< [N m]; with columns().force
  std::vector<Vec3> angular_momentum;  ///< world axes [kg m^2/s]; with columns().anisotropy it is the state, and
                                       ///< determines the angular velocity

  /// Which process owns a body, in runs of several processes.
  enum Owner : std::uint8_t { elsewhere = 0, here = 1, everywhere = 2 };
  std::vector<std::uint8_t> owner;  ///< by slot; empty: all bodies are here
  /// True if this process counts the contact in sums: it owns the contact's first free body.
  bool counts(Slot a, Slot b) const { return owner.empty() || owner[owner[a] == everywhere ? b : a] == here; }

  std::size_t size() const { return id.size(); }
  /// With columns().states: position, velocity, spin and inertia of the bodies; else empty. One more entry after the
  /// last body holds NaN, so that loops over groups of bodies may read past the end without a contact.
  std::span<BodyState> states() { return std::span(states_).subspan(states_before_, state_count()); }
  std::span<const BodyState> states() const { return std::span(states_).subspan(states_before_, state_count()); }
  /// Reserves `count` entries before the first body's for a contact model (balls of clumps). They are not part of the
  /// state. Invalidates the spans of states().
  void set_states_before(std::size_t count);
  std::size_t states_before() const { return states_before_; }
  bool rotates() const { return columns_.rotation; }
  bool has_orientation() const { return columns_.rotation && columns_.orientation; }
  const Columns& columns() const { return columns_; }
  bool is_movable(Slot s) const { return inverse_mass[s] > 0.0; }
  Slot slot_of(BodyId body) const { return slot_of_[static_cast<std::uint32_t>(body)]; }  ///< no_slot when removed
  std::size_t ids_given() const { return slot_of_.size(); }

  /// Position along the path, without wrapping in the periodic cell [m].
  Vec3 unwrapped(Slot s) const {
    return cell ? Vec3(position[s] + wraps[s].cast<double>().cwiseProduct(cell->size)) : position[s];
  }
  /// Position for files: free bodies inside the periodic cell [m]. The columns wrap bodies only now and then.
  Vec3 shown_position(Slot s) const { return cell && is_movable(s) ? cell->inside(position[s]) : position[s]; }
  /// Vector from B to the image of B in contact [m]; the top byte of the feature names the image.
  Vec3 image_shift(Slot a, Slot b, std::uint64_t feature) const {
    const auto key = static_cast<std::uint32_t>(feature >> 56);
    const Wraps passed = wraps[b] - wraps[a];
    return cell->shift(image_code(passed.x() + static_cast<int>(key & 3u), passed.y() + static_cast<int>(key >> 2 & 3u),
                                  passed.z() + static_cast<int>(key >> 4 & 3u)));
  }
  /// Branch vector: from the centre of A to that of B or of B's image in contact [m].
  Vec3 branch(Slot a, Slot b, std::uint64_t feature) const {
    const Vec3 straight = position[b] - position[a];
    return cell ? Vec3(straight + image_shift(a, b, feature)) : straight;
  }

  Pose pose(Slot s) const { return {position[s], has_orientation() ? orientation[s] : Quat(1, 0, 0, 0)}; }
  /// Acceleration without contact forces: gravity and external force [m/s^2]; zero for fixed bodies.
  Vec3 free_acceleration(Slot s) const {
    if (inverse_mass[s] == 0.0) return Vec3::Zero();
    return columns_.external_force ? Vec3(gravity + inverse_mass[s] * external_force[s]) : gravity;
  }
  /// Its part with a potential: constant gravity and external force [m/s^2].
  Vec3 steady_acceleration(Slot s) const {
    Vec3 all = free_acceleration(s);
    if (inverse_mass[s] == 0.0) return all;
    all -= loose_gravity;
    return columns_.loose_force ? Vec3(all - inverse_mass[s] * loose_force[s]) : all;
  }
  /// Total acceleration, with the stored contact force [m/s^2].
  Vec3 acceleration(Slot s) const { return free_acceleration(s) + inverse_mass[s] * force[s]; }
  /// I^-1 x in world axes.
  Vec3 apply_inverse_inertia(Slot s, const Vec3& x) const {
    if (is_isotropic(s)) return inverse_inertia_of(s).x() * x;  // spheres, cubes and fixed bodies: no axes
    return apply_inverse_inertia_at(s, x);
  }
  /// Changes the angular momentum by an impulse [N m s] and the angular velocity with it; free bodies only.
  void apply_angular_impulse(Slot s, const Vec3& impulse) {
    if (columns_.anisotropy)
      apply_angular_impulse_at(s, impulse);
    else
      angular_velocity[s] += inverse_moment[s] * impulse;
  }
  void set_angular_velocity(Slot s, const Vec3& w);
  /// Rotates the orientation over dt [s]: torque-free for free bodies, with constant angular velocity for driven ones.
  void rotate(Slot s, double dt) {
    if (!columns_.orientation || (!columns_.free_turn && is_movable(s))) return;
    if (is_isotropic(s))
      orientation[s] = turned(orientation[s], dt * angular_velocity[s]);
    else
      rotate_at(s, dt);
  }
  /// True for equal principal moments (spheres, cubes), and for fixed bodies.
  bool is_isotropic(Slot s) const {
    if (!columns_.anisotropy) return true;
    const Vec3& i = inverse_inertia[s];
    return i.x() == i.y() && i.y() == i.z();
  }
  /// Principal axes [1/(kg m^2)]; zero for fixed bodies.
  Vec3 inverse_inertia_of(Slot s) const {
    return columns_.anisotropy ? inverse_inertia[s] : Vec3(Vec3::Constant(inverse_moment[s]));
  }

  /// std::invalid_argument where its principal moments are unequal and the world has no column for that.
  BodyId add(const Body& body) {
    const BodyId id_of_body = reserve();
    add(body, id_of_body);
    return id_of_body;
  }
  /// So that no column moves or doubles on the way to so many bodies.
  void reserve(std::size_t bodies);
  /// A name for a body that comes later; it has no slot until then.
  BodyId reserve();
  void add(const Body& body, BodyId reserved);
  /// Takes the bodies out; slots close up. The caller hands the result to every stage.
  Reordering remove(std::span<const BodyId> bodies);
  /// Puts the body of slot order[k] into slot k.
  Reordering reorder(std::span<const Slot> order);

  void visit(StateVisitor& visitor);
  /// Becomes what files show of `from`: everything but forces and momenta. Room is kept for the next time.
  void copy_shown(const World& from);
  /// Bytes of the columns of one body, as `epafi explain` prints them.
  std::size_t bytes_per_body() const;

 private:
  Columns columns_;
  std::uint32_t states_before_ = 0;
  std::vector<Slot> slot_of_;          ///< by body id
  UnwrittenColumn<BodyState> states_;  ///< with columns().states, and one that is nowhere

  Vec3 apply_inverse_inertia_at(Slot s, const Vec3& x) const;
  void apply_angular_impulse_at(Slot s, const Vec3& impulse);
  void rotate_at(Slot s, double dt);
  template <class F>
  void each_column(F&& f);
  std::size_t state_count() const { return states_.empty() ? 0 : states_.size() - states_before_ - 1; }
  void resize_states(std::size_t n);
  void place_states();
};

/// Slots along a Morton (Z-order) curve over the bodies' positions, cell of 1/1024 of the largest extent.
std::vector<Slot> morton_order(const World& world);

/// Hash of id, position, velocity, orientation and angular velocity in the order of body ids: 16 hexadecimal digits.
std::string state_hash(const World& world);

}  // namespace epafi
