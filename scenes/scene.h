/// @file scene.h  The validated description of a scene: plain structs in SI. scenes/reader has resolved names to
/// indices and checked that numbers are finite and in range. A Place is kept for values that later errors, or `epafi
/// explain`, may refer to.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/state/types.h"
#include "engine/step/cell_events.h"
#include "engine/step/domain.h"
#include "engine/step/events.h"
#include "engine/step/loads.h"
#include "engine/step/servo.h"
#include "engine/units/error.h"
#include "engine/units/registry.h"
#include "laws/material.h"
#include "scenes/rare.h"
#include "viz_export/view/settings.h"

namespace epafi {

/// A value and where the user wrote it; line 0: it is a default.
template <class T>
struct Placed {
  T value{};
  Place place{};
  bool written() const { return !place.file.empty(); }
};

/// [run]
struct RunSettings {
  Placed<double> duration;                    ///< [s], > 0
  Placed<std::optional<double>> time_step;    ///< [s], > 0; empty: "auto" or "adaptive"
  bool adaptive = false;                      ///< time_step = "adaptive": divided by the speed of bodies
  bool allow_unstable = false;                ///< accepts a step above the limit, to study instability
  Placed<std::string> scheme;                 ///< resolved from the method where not written
  Placed<double> output_interval;             ///< [s], > 0; default duration / 100
  std::optional<double> checkpoint_interval;  ///< [s], > 0; empty: only at the end and on interruption
  std::uint64_t seed = 1;
};

/// [material.NAME]; index in Scene::materials is the material column of the world.
struct MaterialSpec {
  Material material;  ///< NaN where not written
  Place place;
};

/// [[contact.pair]]: values of one unordered pair of materials.
struct PairSpec {
  std::size_t a = 0, b = 0;  ///< indices of materials, a <= b
  std::optional<double> restitution, friction, rolling_friction;
  Parameters parameters;  ///< of the smooth law, only those written here
  Place place;
};

enum class Method { smooth, nonsmooth };

/// [contact], [contact.smooth], [contact.nonsmooth]
struct ContactSettings {
  Placed<Method> method;
  Placed<double> restitution;       ///< e, in [0, 1]; where absent from [contact], every pair gives its own
  Placed<double> friction;          ///< mu, >= 0
  Placed<double> rolling_friction;  ///< mu_r, >= 0
  Placed<std::string> law;          ///< [contact.smooth] law
  Placed<std::string> tangential;   ///< "" = the law's own
  bool locate_edges = false;        ///< start and end of smooth contacts are located within the step
  Placed<std::string> rolling;      ///< "" = the law's own
  Parameters smooth;                ///< of the law and its parts: written values and defaults
  Placed<std::string> solver;       ///< [contact.nonsmooth] solver
  Parameters nonsmooth;             ///< of the solver: written values and defaults
  Parameters wheel_rail;            ///< [contact.wheel_rail]: written values and defaults
  Place wheel_rail_place{};         ///< line 0: not written
  std::vector<PairSpec> pairs;
};

/// [detection]
struct DetectionSettings {
  Placed<std::string> broad_phase;  ///< "auto" or an entry's name
  Parameters parameters;            ///< of the broad phase: written values and defaults
};

/// [shape.NAME] or a shape written in place (name empty). `type` is the entry's name, `parameters` its fields.
/// polyhedron: exactly one of text("file"), vectors("vertices"), integer("random.vertices") with
/// integer("random.seed"). mesh: text("file"). File names are already relative to the working directory.
struct ShapeSpec {
  std::string name;
  std::string type;
  Parameters parameters;
  std::optional<double> scale_to_diameter;  ///< of the bounding sphere about the centre of mass [m], > 0
  double rounding = 0.0;                    ///< radius of a swept sphere [m], >= 0
  Place place;
};

/// Start of the time of a motion or load: the stage that sets it.
struct Since {
  std::size_t stage = 0;  ///< index in Scene::stages
  double passed = 0.0;    ///< its time in an earlier run that the scene starts from [s]
};

/// motion = { ... } or a list of them, without the servo.
struct MotionSpec {
  std::vector<Motion> parts;
  Since since;
};

/// motion = { servo = { ... } }. Direction, mass and max_speed without a key are 0 until complete_servos().
struct ServoSpec {
  Servo servo;
  Since since;
};

/// remove_at
struct Removal {
  double time = 0.0;  ///< [s]
  Since since;
};

/// Time-dependent force, and torque.
struct TimedLoad {
  TimeVector force, torque;  ///< time-dependent part of the force [N], torque [N m]; empty: none
  Since since;
};

/// One body after `repeat` is unrolled, from [[body]] or a row of [[bodies]].
struct BodySpec {
  std::size_t group = 0;     ///< index in Scene::groups: the table this body came from
  std::size_t shape = 0;     ///< index in Scene::shapes
  double size = 1.0;         ///< factor of all lengths of the shape, > 0
  std::size_t material = 0;  ///< index in Scene::materials
  bool fixed = false;
  bool on_rails = false;    ///< a wheelset whose height and roll are computed
  bool continuous = false;  ///< continuous collision detection
  bool as_drawn = false;    ///< position is that of the origin of the shape's file
  bool absent = false;      ///< removed; keeps its number in the group
  Rare<MotionSpec> motion;  ///< of a driven body
  Rare<ServoSpec> servo;    ///< of a servo wall
  Rare<TimedLoad> load;
  Rare<Removal> remove_at;
  Vec3 position = Vec3::Zero();                               ///< of the centre of mass, or as_drawn [m]
  Quat orientation = Quat(1, 0, 0, 0);                        ///< of the axes of the scene or file, unit
  Vec3 velocity = Vec3::Zero();                               ///< [m/s]
  Vec3 angular_velocity = Vec3::Zero();                       ///< world axes [rad/s]
  Rare<Vec3> force;                                           ///< constant part of the external force [N]
  Rare<Place> spin_place;                                     ///< where an angular velocity was written
  bool moves() const { return !fixed && !motion && !servo; }  ///< free: has mass, is integrated
};

/// A [[body]] or [[bodies]] table: its bodies are Scene::bodies[first .. first + count).
struct GroupSpec {
  std::string name;  ///< may be empty
  std::size_t first = 0, count = 0;
  Place place;
  std::vector<std::size_t> repeat{};  ///< bodies along each index; one for rows of a file; empty: one body, no index
  std::string group{};                ///< a name that it shares with others; may be empty
  std::size_t stage = 0;              ///< that adds it, index in Scene::stages
  std::optional<std::size_t> from{};  ///< its number among the groups of the run that the scene starts from
  bool is_left_out = false;           ///< [start] takes none of its bodies
};

/// Name of the k-th body of a group: "stack[3]", "grid[0,1,2]" or the plain name; empty where the group has none.
inline std::string body_name(const GroupSpec& group, std::size_t k) {
  if (group.name.empty() || group.repeat.empty()) return group.name;
  std::string index;
  for (std::size_t d = group.repeat.size(); d-- > 0; k /= group.repeat[d])
    index = std::to_string(d > 0 ? k % group.repeat[d] : k) + (index.empty() ? "" : "," + index);
  return group.name + "[" + index + "]";
}

/// A box [m].
struct Region {
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();
};

/// Changes of bodies by a stage: body.NAME = { ... }.
struct BodyChange {
  std::optional<std::size_t> one{};  ///< of the named bodies of a fill; empty: all
  std::optional<bool> fixed{};
  bool remove = false;
  bool moves = false;  ///< changes motion and servo, possibly to none
  std::optional<MotionSpec> motion{};
  std::optional<ServoSpec> servo{};
  bool loads = false;  ///< changes force and torque, possibly to none
  std::optional<Vec3> force{};
  std::optional<TimedLoad> load{};
};
void apply(const BodyChange& change, BodySpec& body);

/// [[fill]]
struct FillSpec {
  enum class Method { lattice, random, pour };
  /// Factor of the shape's size.
  struct Size {
    std::string distribution = "uniform";  ///< uniform, normal, lognormal, table
    double min = 1.0, max = 1.0;           ///< all sizes lie between, > 0
    double mean = 1.0, deviation = 0.0;    ///< normal and lognormal: of the factor, before truncation
    std::vector<double> values, shares;    ///< table: sizes and how many bodies have them, same length
  };
  std::string name;                 ///< of the group; "fill" where not written
  std::vector<std::size_t> shapes;  ///< indices in Scene::shapes
  std::vector<double> weights;      ///< by shape, of number, > 0; same length as shapes
  std::optional<Size> size;
  std::size_t material = 0;
  std::optional<std::uint64_t> count;  ///< exactly one of count, mass, full
  std::optional<double> mass;          ///< [kg]
  bool full = false;
  Region region;
  Method method = Method::lattice;
  std::uint64_t seed = 1;
  Vec3 velocity = Vec3::Zero();     ///< [m/s]
  double velocity_deviation = 0.0;  ///< standard deviation of each component of random velocities [m/s], >= 0
  double rate = 0.0;                ///< pour: bodies per second [1/s], or 0
  double mass_rate = 0.0;           ///< pour: [kg/s], or 0
  double from = 0.0;                ///< pour: start time [s]
  Place place;
  std::string group{};    ///< a name that it shares with others; may be empty
  std::size_t stage = 0;  ///< that adds it, index in Scene::stages
  std::vector<BodyChange> changes{};
};

/// [[outlet]]: free bodies whose centres enter the box are removed and counted.
struct OutletSpec {
  std::string name;
  Region region;
  Place place;
};

/// [[spring]]
struct SpringSpec {
  std::string name;
  std::size_t body = 0;            ///< index in Scene::bodies
  std::optional<std::size_t> to;   ///< index in Scene::bodies; none: a frame that moves along the track
  double speed = 0.0;              ///< of the frame [m/s]
  Vec3 attachment = Vec3::Zero();  ///< axes of the body [m]
  Vec3 stiffness = Vec3::Zero(), damping = Vec3::Zero(),
       preload = Vec3::Zero();  ///< axes of the far end [N/m], [N s/m], [N]
  Place place;
};

/// [world] domain: periodic, strain_rate, pressure.
struct CellSpec {
  PeriodicCell cell;
  CellControl control;  ///< a rate_limit of 0: chosen from pressure and sizes
  bool deforms = false;
  Place place;
};

/// Bodies of a name: of the scene and of its fills.
struct NamedBodies {
  /// Scene::bodies[first .. first + count).
  struct Range {
    std::size_t first = 0, count = 0;
    bool operator==(const Range&) const = default;
  };
  std::vector<Range> bodies;
  std::vector<std::pair<std::size_t, std::optional<std::size_t>>> fills;  ///< index of the fill, of its body or all
};

/// [[measure]]: kind is the entry's name, parameters its fields (plane.point, plane.normal (unit), body, between,
/// region.box.min, ...). Names of bodies are resolved in `bodies`.
struct MeasureSpec {
  std::string name;
  std::string kind;
  double interval = 0.0;  ///< [s]; 0: every step
  bool thinned = false;   ///< without interval: evaluates every step, writes 10 000 rows at most
  Parameters parameters;
  std::vector<NamedBodies> bodies;  ///< of body = NAME (one) or between = [NAME, NAME] (two)
  Place place;
};

/// Condition on a measure.
struct Condition {
  std::string measure, component;
  double limit = 0.0;
  bool above = false;     ///< true above the limit, else below
  double duration = 0.0;  ///< for which it must hold without interruption [s]
  bool holds(double value) const { return above ? value > limit : value < limit; }
};

/// One entry of [bounds] or [accuracy].
struct BoundSpec {
  std::string quantity;  ///< energy_error, overlap_relative, momentum_error, residual, drift, sag, measure
  double limit = 0.0;    ///< value <= limit
  bool stops = false;    ///< then = "stop": ends the run early, without failure
  Condition broken{};    ///< of `measure`: condition that violates the bound
  std::string body;      ///< of drift and sag
  NamedBodies bodies;    ///< resolved
  double after = 0.0;    ///< [s]
  Place place;
};

/// "key.path" = [values]: values as TOML text, ready for `--set`.
struct Variation {
  std::string key;
  std::vector<std::string> values;
  Place place;
};

/// [benchmark]
struct BenchmarkSpec {
  std::vector<Variation> sizes;
  std::string error;
  Place place;
};

/// [[stage]]; a scene without [[stage]] has one of the whole duration.
struct StageSpec {
  std::string name;       ///< empty where the scene has no [[stage]]
  double duration = 0.0;  ///< [s], > 0; with a condition the longest time
  std::optional<Condition> until{};
  Place place{};
};

/// [start]: an earlier run that provides bodies of this scene.
struct StartSpec {
  std::string run;                   ///< folder
  std::string hash;                  ///< of the data taken from it
  std::size_t bodies = 0;            ///< number of Scene::bodies that come from it, with their numbers there
  std::vector<std::string> dropped;  ///< data that are not taken, for the report
  bool at_rest = false;              ///< sets velocities to 0
  Vec3 move = Vec3::Zero();          ///< [m]
  Quat turn = Quat(1, 0, 0, 0);      ///< about the origin, before the move
  bool turned = false;
  bool goes_on = false;          ///< continues its time and files: `epafi resume DIR --scene`
  std::optional<double> time{};  ///< of a snapshot [s]
  bool keeps_memory() const { return !turned && !time; }
  std::shared_ptr<struct MadeRun> made{};  ///< until the bodies have positions
  Place place{};
};

/// [output]
struct OutputSettings {
  std::optional<Placed<double>> problems_every;  ///< interval of files with contact problems [s]
  Placed<bool> orientation{false, {}};           ///< of spheres too
};

struct Scene {
  std::string title;
  std::string file;                  ///< as given to the reader
  std::string text;                  ///< the whole text with includes and overrides: hashed, stored
  std::vector<std::string> files{};  ///< other files that determine the run, of all stages: tables, bodies, shapes
  RunSettings run;
  Vec3 gravity = Vec3::Zero();  ///< the constant part [m/s^2]
  TimeVector loose_gravity{};   ///< the time-dependent part; empty: none
  Since gravity_since{};
  std::optional<Placed<Domain>> domain;
  std::optional<CellSpec> cell;
  std::vector<MaterialSpec> materials;
  ContactSettings contact;
  DetectionSettings detection;
  std::vector<ShapeSpec> shapes;
  std::vector<BodySpec> bodies;
  std::vector<GroupSpec> groups;
  std::vector<FillSpec> fills;
  std::vector<OutletSpec> outlets;
  std::vector<SpringSpec> springs;
  std::vector<MeasureSpec> measures;
  std::vector<BoundSpec> bounds;
  std::vector<BoundSpec> accuracy;
  std::vector<Variation> sweep;
  std::optional<BenchmarkSpec> benchmark;
  OutputSettings output;
  ViewSettings view;
  std::vector<StageSpec> stages;  ///< one at least
  std::size_t stage = 0;          ///< index of the stage that this scene describes
  std::optional<StartSpec> start{};
  std::function<Scene(std::size_t)> stage_of{};  ///< the same scene at another stage; throws SceneError
  bool changes_bodies = false;  ///< relative to the stage or run before: bodies, their motion or `fixed`
};

/// Name of Scene::bodies[k].
inline std::string body_name(const Scene& scene, std::size_t k) {
  const GroupSpec& group = scene.groups[scene.bodies[k].group];
  return body_name(group, k - group.first);
}

/// Every unordered pair of the scene's materials with its values from [contact] and [[contact.pair]].
MaterialTable material_table(const Scene& scene);

}  // namespace epafi
