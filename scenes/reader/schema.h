/// @file schema.h  One declaration per table of a scene file: what is read, checked, printed by `epafi schema` and
/// documented.
#pragma once
#include <string>
#include <vector>

#include "engine/units/registry.h"
#include "scenes/reader/registry.h"

namespace epafi {

/// A table of the scene file. Laws, solvers, shapes, broad phases, schemes and measures bring their own fields.
struct TableSchema {
  enum class Form {
    single,  ///< [name]
    named,   ///< [name.ANY], one for each name the user chooses
    list,    ///< [[name]], any number
    free,    ///< [name] with keys the user chooses
  };
  std::string name;  ///< "run", "contact.smooth", "contact.pair", "shape"
  Form form = Form::single;
  std::string summary;
  std::vector<Field> fields;
};

struct SceneSchema {
  std::vector<TableSchema> tables;
  const TableSchema& at(const std::string& name) const;
};

SceneSchema make_schema(const Registry& registry);

/// The fields of all entries, each name once: an entry before the others if `chosen` names it.
std::vector<Field> united_fields(const std::vector<Entry>& entries, const std::string& chosen = {});

/// The names of the chosen law and its parts; empty where the scene leaves them open.
struct LawChoice {
  std::string law, tangential, rolling;
};

/// The fields of all parts of smooth laws, those of the chosen ones first; none is required here.
std::vector<Field> smooth_fields(const Registry& registry, const LawChoice& chosen = {});

/// The keys that say the same of [contact] and of one pair: restitution, friction, rolling_friction.
std::vector<Field> pair_values();

/// a, and those of b whose names are not in a.
std::vector<Field> operator+(std::vector<Field> a, const std::vector<Field>& b);

/// The same fields, none of them required.
std::vector<Field> as_optional(std::vector<Field> fields);

/// Values at times: table or file, columns, unit, scale.
std::vector<Field> time_table_fields();

/// A bound as a table: below, then.
std::vector<Field> number_bound_fields();

/// The keys of a shape as a scene writes them. A polyhedron and a mesh are written as files, vertices or chance;
/// what the engine makes of them is the business of detection/shapes.
std::vector<Field> authoring_fields(const Entry& shape);

}  // namespace epafi
