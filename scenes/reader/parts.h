/// @file parts.h  The steps of reading a scene, each for one group of tables. Internal to scenes/reader.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenes/reader/stages.h"
#include "scenes/reader/table_reader.h"
#include "scenes/scene.h"

namespace epafi {

/// A scene in the making.
struct Draft {
  Reading& reading;
  Scene scene;
  std::optional<std::size_t> unit_sphere{};  ///< the shape of all rows of [[bodies]] with a radius
  const std::vector<Node>* stages = nullptr;
  std::size_t stage = 0;  ///< the one that is read
  std::vector<ChangeOfBodies> body_changes{};
  std::size_t stage_of_gravity = 0;                 ///< the last one that sets it
  std::string start_run{};                          ///< as ReadOptions has it
  std::shared_ptr<struct MadeRun>* made = nullptr;  ///< the run named by [start], kept for all stages
};

void read_run(Draft& draft);
void read_world(Draft& draft);
void read_materials(Draft& draft);
void read_contact(Draft& draft);
void read_detection(Draft& draft);
void read_shapes(Draft& draft);
void read_bodies(Draft& draft);
void read_body_files(Draft& draft);
/// A file of bodies whose table has been read.
struct BodyFile {
  std::string path, name;
  std::size_t material = 0;
  bool fixed = false;
};
void read_polyset(Draft& draft, const BodyFile& file);
void read_fills(Draft& draft);
void read_stages(Draft& draft);        ///< their durations
void read_start(Draft& draft);         ///< [start]: data from another run
void read_stage_bodies(Draft& draft);  ///< body.NAME of stages, when all bodies are there
void check_stage(Draft& draft);        ///< checks that need the measures
void read_outlets(Draft& draft);
void read_springs(Draft& draft);
void read_measures(Draft& draft);
void read_bounds(Draft& draft);
void read_studies(Draft& draft);  ///< [sweep], [benchmark], [output]
void read_view(Draft& draft);
/// Checks that need all bodies: restitution and friction of pairs that can touch, densities of free bodies.
void check_pairs(Draft& draft);

/// `motion` of a body: a table or a list of them. No parts and no servo: an empty list, the body is not driven.
struct MotionsRead {
  std::vector<Motion> parts;
  std::optional<Servo> servo;
};
MotionsRead read_motions(Reading& reading, const Node& node, const std::string& label);
/// Rows of `table` or `file` of an item, in SI.
std::optional<MotionTable::Rows> read_time_rows(Reading& reading, const Node& item, const TableValues& v,
                                                const std::string& unit, const std::string& label);
/// A value that depends on time, at least in part.
struct TimedVector {
  Vec3 steady = Vec3::Zero();
  TimeVector loose;
};
TimedVector read_time_vector(Reading& reading, const Node& node, const std::string& unit, const std::string& label);
/// force and torque of a body.
void read_body_loads(Reading& reading, const Node& item, const TableValues& v, const std::string& label, Since since,
                     BodySpec& body);
/// measure, component, above or below, for.
Condition read_condition(Reading& reading, const TableValues& v, const std::string& prefix, const std::string& label);
/// Checks that its measure exists.
void check_condition(Draft& draft, const Condition& condition, const Place& place, const std::string& label);

/// The table of that name (dots step inwards) or null; reports what is not a table.
const Node* find_table(Reading& reading, const std::string& name);
/// The table, or an empty one in its place so that defaults are set.
const Node& table_or_empty(Reading& reading, const std::string& name);
/// Every element of [[name]].
void each_item(Reading& reading, const std::string& name, const std::function<void(const Node&)>& visit);
/// "[[body]] 'floor'" or "[[body]]".
std::string item_label(const std::string& name, const Node& item);

/// Index of a material or shape by name; reports an unknown one with the nearest.
std::optional<std::size_t> find_material(Draft& draft, const std::string& name, const Place& place,
                                         const std::string& label);
std::optional<std::size_t> find_shape(Draft& draft, const std::string& name, const Place& place,
                                      const std::string& label);
/// Notes that free bodies have the shape: a mesh becomes a solid.
void let_move(Draft& draft, std::size_t shape);

/// True where shapes of this form are walls only: without a volume they cannot move freely.
bool is_only_wall(const std::string& form);
/// A shape by name or written in place.
std::optional<std::size_t> read_shape_value(Draft& draft, const Node& node, const std::string& label);
/// Adds a shape table; reports if it is not exactly one form.
std::optional<std::size_t> add_shape(Draft& draft, const Node& table, const std::string& name,
                                     const std::string& label);

/// The last group may be one of the run that the scene starts from; its bodies then replace those.
void settle_imported(Draft& draft);

/// Reports a group name that is taken.
void check_group_name(Draft& draft, const std::string& name, const Place& place);
/// The bodies a name stands for: a group or a fill, or one of its bodies; reports an unknown one.
NamedBodies find_bodies(Draft& draft, const std::string& name, const Place& place, const std::string& label);
/// min < max in every component, else reported.
bool check_box(Reading& reading, const Vec3& min, const Vec3& max, const Place& place, const std::string& label);
/// A direction of any length but 0, made a unit vector.
std::optional<Vec3> unit_vector(Reading& reading, const Vec3& direction, const Place& place, const std::string& label);

}  // namespace epafi
