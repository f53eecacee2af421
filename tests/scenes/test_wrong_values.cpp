// Every key of the scene file meets every kind of value: taken or refused, nothing else.
#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

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

namespace {

const std::string sound_scene = R"([run]
duration = 1
time_step = 1e-3
[material.a]
density = 1000
youngs_modulus = 1e6
poissons_ratio = 0.3
[contact]
method = "smooth"
restitution = 0.5
friction = 0.3
[shape.ball]
sphere = { radius = 0.1 }
[[fill]]
shape = "ball"
material = "a"
count = 3
size = { distribution = "uniform", min = 0.9, max = 1.1 }
region = { box = { min = [0, 0, 2], max = [9, 9, 9] } }
[[fill]]
name = "rain"
shape = "ball"
material = "a"
count = 3
method = "pour"
rate = 10
region = { box = { min = [0, 0, 2], max = [9, 9, 9] } }
[[measure]]
name = "share"
kind = "solid_fraction"
region = { box = { min = [0, 0, 2], max = [9, 9, 9] } }
)";

std::vector<std::string> errors_of(const std::string& text) {
  std::vector<std::string> all;
  for (const Problem& p : read_scene_text(text, "scene.toml", {}, full_registry()).problems)
    if (p.level == Problem::Level::error) all.push_back(p.to_string());
  return all;
}

}  // namespace

TEST_CASE("a key that is misspelt, or whose value is wrong, is told once and not as missing", "[scenes][reader]") {
  CHECK(errors_of(sound_scene).empty());
  for (const std::string key : {"duration", "time_step", "density", "method", "shape", "material", "count",
                                "distribution", "min", "max", "region", "box", "rate", "kind", "radius", "name"}) {
    for (std::size_t at = sound_scene.find(key + " = "); at != std::string::npos;
         at = sound_scene.find(key + " = ", at + 1)) {
      if (at > 0 && std::isalnum(static_cast<unsigned char>(sound_scene[at - 1]))) continue;
      std::string text = sound_scene;
      text.insert(at, 1, key[0]);  // its first letter twice
      const auto errors = errors_of(text);
      INFO(text);
      CAPTURE(errors);
      REQUIRE(errors.size() == 1);
      CHECK_THAT(errors[0], Catch::Contains("unknown key '" + key.substr(0, 1) + key + "'") &&
                                Catch::Contains("did you mean '" + key + "'?"));
    }
  }
  const std::pair<const char*, const char*> wrong[] = {
      {"max = 1.1", "max = \"2 m/s\""},  {"min = 0.9", "min = true"},  {"count = 3", "count = nan"},
      {"rate = 10", "rate = []"},        {"[0, 0, 2]", "[0, nan, 2]"}, {"radius = 0.1", "radius = \"\""},
      {"duration = 1", "duration = inf"}};
  for (const auto& [right, written] : wrong) {
    for (std::size_t at = sound_scene.find(right); at != std::string::npos; at = sound_scene.find(right, at + 1)) {
      std::string text = sound_scene;
      text.replace(at, std::string(right).size(), written);
      INFO(text);
      CHECK(errors_of(text).size() == 1);
    }
  }
}

TEST_CASE("a zero in a text is told where it stands", "[scenes][reader]") {
  // messages ended at it, and with them what was allowed
  for (const std::string key : {"duration", "density", "method", "shape", "material", "count", "kind", "name"}) {
    std::string text = sound_scene;
    const std::size_t at = text.find("\n" + key + " = ") + key.size() + 4;
    text.replace(at, text.find('\n', at) - at, "\"a\\u0000b\"");
    const auto errors = errors_of(text);
    INFO(text);
    CAPTURE(errors);
    REQUIRE(errors.size() == 1);
    CHECK_THAT(errors[0], Catch::Contains("the character U+0000") && Catch::Contains("scene.toml:"));
  }
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
