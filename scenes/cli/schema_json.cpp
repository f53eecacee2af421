#include "scenes/cli/schema_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/cli/list.h"
#include "scenes/patch/patch_schema.h"
#include "scenes/reader/fields.h"
#include "scenes/reader/schema.h"
#include "scenes/reader/table_reader.h"

namespace epafi {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (c == '\n')
      out += "\\n";
    else
      out += c;
  }
  return out + "\"";
}

/// An object under construction: members in order.
struct Object {
  std::string text;
  Object& add(const std::string& key, const std::string& value) {
    text += (text.empty() ? "" : ",") + quoted(key) + ":" + value;
    return *this;
  }
  std::string str() const { return "{" + text + "}"; }
};

template <class List, class F>
std::string array(const List& items, F&& one) {
  std::string all;
  for (const auto& item : items) all += (all.empty() ? "" : ",") + one(item);
  return "[" + all + "]";
}

std::string describe(const Field& field) {
  std::string text = field.help;
  if (!field.symbol.empty()) text += " (" + field.symbol + ")";
  if (!field.unit.empty()) text += " [" + field.unit + "]";
  if (field.default_value) text += "; default " + format_value(*field.default_value);
  return text;
}

std::string json_value(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return quoted(*text);
  if (const auto* words = std::get_if<std::vector<std::string>>(&value)) return array(*words, quoted);
  return format_value(value);
}

/// A number in SI, or a text: with a unit or "= expression".
std::string number_schema(const Field& field) {
  Object number;
  number.add("type", field.kind == Kind::integer || field.kind == Kind::integers ? "\"integer\"" : "\"number\"");
  if (std::isfinite(field.range.min))
    number.add(field.range.open_min ? "exclusiveMinimum" : "minimum", format_number(field.range.min));
  if (std::isfinite(field.range.max))
    number.add(field.range.open_max ? "exclusiveMaximum" : "maximum", format_number(field.range.max));
  return "{\"anyOf\":[" + number.str() + ",{\"type\":\"string\"}]}";
}

std::string list_schema(const std::string& items, int size = 0) {
  Object list;
  list.add("type", "\"array\"").add("items", items);
  if (size > 0) list.add("minItems", std::to_string(size)).add("maxItems", std::to_string(size));
  return list.str();
}

std::string any_of(const std::string& a, const std::string& b) { return "{\"anyOf\":[" + a + "," + b + "]}"; }

struct Writer {
  const SceneSchema& schema;

  std::string word(const Field& field) const {
    Object text;
    text.add("type", "\"string\"");
    if (!field.choices.empty()) text.add("enum", array(field.choices, quoted));
    return text.str();
  }
  std::string type_of(const Field& field, const std::string& parent) const {
    std::string number = number_schema(field);
    switch (field.kind) {
      case Kind::number:
      case Kind::integer:
        return number;
      case Kind::boolean:
        return "{\"type\":\"boolean\"}";
      case Kind::text:
        return word(field);
      case Kind::vec3:
        return list_schema(number, 3);
      case Kind::quaternion:
        return list_schema(number, 4);
      case Kind::numbers:
        return list_schema(number);
      case Kind::integers:
        return any_of(number, list_schema(number));
      case Kind::vectors:
        return list_schema(list_schema(number, 3));
      case Kind::quadruples:
        return list_schema(list_schema(number, 4));
      case Kind::texts:
        return any_of(word(field), list_schema(word(field)));
      case Kind::table:
        return field.choices.empty() ? object(field.fields, "") : any_of(word(field), object(field.fields, ""));
      case Kind::rows:
        return list_schema(list_schema(number));
      case Kind::load:
        return any_of(list_schema(number, 3), object(time_table_fields(), ""));
      case Kind::motions:
        return any_of(object(field.fields, ""), list_schema(object(field.fields, "")));
      case Kind::bound:
        return any_of(number, object(number_bound_fields(), ""));
      case Kind::shape:
        return any_of("{\"type\":\"string\"}", "{\"$ref\":\"#/definitions/shape\"}");
      case Kind::tables:
        return table(schema.at(parent + "." + field.name));
    }
    return "{}";
  }
  std::string object(const std::vector<Field>& fields, const std::string& name) const {
    Object properties;
    std::vector<std::string> needed;
    for (const auto& field : fields) {
      const bool or_table = name == "start" && field.name == "from";  // a table of the other keys
      const std::string type =
          or_table ? any_of(word(field), object({fields.begin() + 1, fields.end()}, "")) : type_of(field, name);
      if (field.kind == Kind::tables) {  // described by its own declaration
        properties.add(field.name, type);
        continue;
      }
      Object about;
      about.add("description", quoted(describe(field)));
      if (field.default_value) about.add("default", json_value(*field.default_value));
      properties.add(field.name, "{" + about.text + "," + type.substr(1));
      const bool of_stages = name == "run" && field.name == "duration";  // absent where there are any
      if (!field.optional && !field.default_value && !of_stages) needed.push_back(field.name);
    }
    Object out;
    const bool open = name == "stage";  // keys of the whole scene
    out.add("type", "\"object\"");
    if (!open) out.add("additionalProperties", "false");
    out.add("properties", properties.str());
    if (!needed.empty()) out.add("required", array(needed, quoted));
    return out.str();
  }
  std::string table(const TableSchema& declared) const {
    using Form = TableSchema::Form;
    const std::string one =
        declared.form == Form::free ? "{\"type\":\"object\"}" : object(declared.fields, declared.name);
    const std::string about = "{\"description\":" + quoted(declared.summary) + ",";
    if (declared.form == Form::list) return about + list_schema(one).substr(1);
    if (declared.form == Form::named) {
      const std::string ref = declared.name == "shape" ? "{\"$ref\":\"#/definitions/shape\"}" : one;
      return about + "\"type\":\"object\",\"additionalProperties\":" + ref + "}";
    }
    return about + one.substr(1);
  }
};

/// Scenes and patch cases share the files and the editor: the keys of both, those of patch cases added.
SceneSchema with_patch_cases(SceneSchema schema) {
  const auto extend = [&](const char* name, const std::vector<Field>& more) {
    for (TableSchema& t : schema.tables)
      if (t.name == name) t.fields = t.fields + more;
  };
  extend("contact", patch_contact_fields());
  extend("material", as_optional(patch_material_fields()));
  for (TableSchema& t : schema.tables)  // a patch case has no mechanics to choose
    if (t.name == "contact")
      for (Field& f : t.fields) f.optional = f.optional || f.name == "method";
  schema.tables.push_back({"patch", TableSchema::Form::single,
                           "one wheel-rail or Hertzian contact in statics (`epafi patch`)", patch_fields()});
  return schema;
}

}  // namespace

std::string json_schema(const Registry& registry) {
  const SceneSchema schema = with_patch_cases(make_schema(registry));
  const Writer writer{schema};
  Object properties;
  properties.add("title", "{\"type\":\"string\"}");
  properties.add(
      "include",
      "{\"description\":\"files merged below this one\",\"type\":\"array\",\"items\":{\"type\":\"string\"}}");
  for (const auto& table : schema.tables)
    if (table.name.find('.') == std::string::npos) properties.add(table.name, writer.table(table));
  Object root;
  root.add("$schema", "\"http://json-schema.org/draft-07/schema#\"")
      .add("title", "\"Epafi scene\"")
      .add("type", "\"object\"");
  root.add("additionalProperties", "false")
      .add("anyOf", "[{\"required\":[\"run\"]},{\"required\":[\"stage\"]},{\"required\":[\"patch\"]}]")
      .add("properties", properties.str());
  Object definitions;
  definitions.add("shape", writer.object(schema.at("shape").fields, "shape"));
  root.add("definitions", definitions.str());
  return root.str() + "\n";
}

}  // namespace epafi
