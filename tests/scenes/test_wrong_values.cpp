// Every key of the scene file meets every kind of value: taken or refused, nothing else.
#include <algorithm>
#include <map>

#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/reader/schema.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// A small scene with one table for each that is asked for; a line of its own takes the place of the key it sets.
std::string scene_with(const TableSchema& table, const std::string& key, const std::string& value) {
  const std::map<std::string, std::map<std::string, std::string>> sound{
      {"run", {{"duration", "1"}, {"time_step", "1e-3"}}},
      {"material", {{"density", "1000"}, {"youngs_modulus", "1e6"}, {"poissons_ratio", "0.3"}}},
      {"body", {{"name", "'ball'"}, {"material", "'a'"}, {"shape", "{ sphere = { radius = 1 } }"}}},
      {"contact", {{"method", "'smooth'"}}},
      {"contact.pair", {{"between", "['a', 'a']"}}},
      {"measure", {{"kind", "'energy'"}}},
      {"fill",
       {{"material", "'a'"},
        {"shape", "{ sphere = { radius = 1 } }"},
        {"count", "3"},
        {"region", "{ box = { min = [0, 0, 2], max = [9, 9, 9] } }"}}}};
  std::string text;
  const auto add = [&](const std::string& name, TableSchema::Form form, std::map<std::string, std::string> lines,
                       bool tested) {
    if (tested) lines[key] = value;
    if (form == TableSchema::Form::list)
      text += "[[" + name + "]]\n";
    else
      text += "[" + name + (form == TableSchema::Form::named ? ".a" : "") + "]\n";
    for (const auto& [k, v] : lines) text += k + " = " + v + "\n";
  };
  using Form = TableSchema::Form;
  for (const auto& [name, lines] : sound)
    if (name == table.name || (name != "measure" && name != "fill" && name != "contact.pair"))
      add(name,
          name == "run" || name == "contact" ? Form::single
          : name == "material"               ? Form::named
                                             : Form::list,
          lines, name == table.name);
  if (sound.count(table.name) == 0) add(table.name, table.form, {}, true);
  return text;
}

}  // namespace

TEST_CASE("every key of every table takes or refuses every kind of value", "[scenes][reader][long]") {
  const std::vector<std::string> values{"3",           "-1.5",  "true",      "'x'",         "'= 1/0'",
                                        "nan",         "[]",    "{}",        "[1]",         "[1, 2, 3]",
                                        "[[1, 2, 3]]", "['a']", "{ x = 1 }", "[{ x = 1 }]", "['a', 'b']"};
  std::size_t taken = 0, refused = 0;
  const auto try_key = [&](const TableSchema& table, const std::string& key, const std::string& before,
                           const std::string& after) {
    for (const std::string& value : values) {
      const std::string text = scene_with(table, key, before + value + after);
      INFO(text);
      const ReadResult read = read_scene_text(text, "scene.toml", {}, full_registry());
      CHECK(read.scene.has_value() == std::none_of(read.problems.begin(), read.problems.end(),
                                                   [](const Problem& p) { return p.level == Problem::Level::error; }));
      ++(read.scene ? taken : refused);
    }
  };
  for (const TableSchema& table : make_schema(full_registry()).tables)
    for (const Field& field : table.fields) {
      try_key(table, field.name, "", "");
      for (const Field& inner : field.fields) {
        try_key(table, field.name, "{ " + inner.name + " = ", " }");
        for (const Field& innermost : inner.fields)
          try_key(table, field.name, "{ " + inner.name + " = { " + innermost.name + " = ", " } }");
      }
    }
  CAPTURE(taken, refused);
  CHECK((taken > 80 && refused > 2000));
}

TEST_CASE("every key of every kind of measure takes or refuses every kind of value", "[scenes][reader]") {
  const Registry registry = full_registry();
  const std::vector<std::string> values{"3",
                                        "-1.5",
                                        "true",
                                        "'ball'",
                                        "nan",
                                        "[]",
                                        "{}",
                                        "[1]",
                                        "[1, 2, 3]",
                                        "['ball']",
                                        "['none']",
                                        "['ball', 'none']",
                                        "{ x = 1 }",
                                        "['', '']",
                                        "['ball', 'ball']",
                                        "['ball', 'ball', 'ball']",
                                        "''"};
  std::size_t refused = 0;
  for (const Entry& kind : registry.measures)
    for (const Field& field : kind.fields)
      for (const std::string& value : values) {
        const std::string text =
            "run = { duration = 1, time_step = 1e-3 }\nmaterial.a = { density = 1, youngs_modulus = 1, poissons_ratio "
            "= 0 "
            "}\ncontact = { method = 'smooth', restitution = 1, friction = 0 }\n[[body]]\nname = 'ball'\nmaterial = "
            "'a'\nshape = { sphere = { radius = 1 } }\n[[measure]]\nkind = '" +
            kind.name + "'\n" + field.name + " = " + value + "\n";
        INFO(text);
        const ReadResult read = read_scene_text(text, "scene.toml", {}, registry);
        CHECK(read.scene.has_value() == std::none_of(read.problems.begin(), read.problems.end(), [](const Problem& p) {
                return p.level == Problem::Level::error;
              }));
        refused += !read.scene;
      }
  CHECK(refused > 200);
}

TEST_CASE("a measure between two takes two names", "[scenes][reader]") {
  for (const std::string names : {"['a']", "['a', 'b', 'a']", "[]"})
    for (const std::string kind : {"contact", "hysteresis", "mixing"}) {
      const ReadResult read = read_scene_text(
          "run = { duration = 1, time_step = 1e-3 }\nmaterial.m = { density = 1, youngs_modulus = 1, poissons_ratio = "
          "0 "
          "}\ncontact = { method = 'smooth', restitution = 1, friction = 0 }\n[[body]]\nname = 'a'\nmaterial = "
          "'m'\nshape = { sphere = { radius = 1 } }\n[[body]]\nname = 'b'\nmaterial = 'm'\nposition = [3, 0, "
          "0]\nshape = { sphere = { radius = 1 } }\n[[measure]]\nkind = '" +
              kind + "'\nbetween = " + names + (kind == "mixing" ? "\ncell = 1\n" : "\n"),
          "scene.toml", {}, full_registry());
      REQUIRE_FALSE(read.scene);
      CHECK_THAT(read.problems[0].to_string(), Catch::Contains("between") && Catch::Contains("2"));
    }
}
