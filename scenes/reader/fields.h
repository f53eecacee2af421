/// @file fields.h  Short notation for the fields of scene tables.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "engine/units/registry.h"

namespace epafi {

inline Field required(std::string name, std::string symbol, std::string unit, Kind kind, Range range,
                      std::string help) {
  return {std::move(name), std::move(symbol), std::move(unit), kind, std::nullopt, range, std::move(help)};
}
inline Field optional(std::string name, std::string symbol, std::string unit, Kind kind, Range range,
                      std::string help) {
  Field field = required(std::move(name), std::move(symbol), std::move(unit), kind, range, std::move(help));
  field.optional = true;
  return field;
}
inline Field with_default(Field field, Value value) {
  field.default_value = std::move(value);
  return field;
}
inline Field table(std::string name, std::string help, std::vector<Field> fields) {
  Field field = optional(std::move(name), "", "", Kind::table, {}, std::move(help));
  field.fields = std::move(fields);
  return field;
}
inline Field tables(std::string name, std::string help) {
  return optional(std::move(name), "", "", Kind::tables, {}, std::move(help));
}
inline Field needed(Field field) {
  field.optional = false;
  return field;
}
inline Field word(std::string name, std::string help, std::vector<std::string> choices) {
  Field field = required(std::move(name), "", "", Kind::text, {}, std::move(help));
  field.choices = std::move(choices);
  return field;
}
inline Field text(std::string name, std::string help) {
  return required(std::move(name), "", "", Kind::text, {}, std::move(help));
}

}  // namespace epafi
