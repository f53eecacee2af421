// What `epafi list` and `epafi schema` print.
#include "engine/error.h"
#include "scenes/cli/list.h"
#include "scenes/cli/schema_json.h"
#include "scenes/reader/document.h"
#include "scenes/reader/schema.h"
#include "scenes/reader/table_reader.h"
#include "tests/support/catch.h"
#include "tests/support/scene_registry.h"

using namespace epafi;

TEST_CASE("a listed parameter shows symbol, unit, default and range", "[scenes][list]") {
  const std::string text = list_text(test_registry(), "solvers");
  CHECK(text.find("pgs") != std::string::npos);
  CHECK(text.find("relaxation") != std::string::npos);
  CHECK(text.find("omega_r") != std::string::npos);
  CHECK(text.find("in (0, 2), default 1") != std::string::npos);
  CHECK(text.find("sphere") == std::string::npos);
  CHECK(list_text(test_registry(), "shapes")
            .find("radius                  r [m]             radius, in (0, inf), required") != std::string::npos);
}

TEST_CASE("every entry of every list is listed", "[scenes][list]") {
  const Registry r = test_registry();
  const std::string text = list_text(r);
  for (const auto* list : {&r.shapes, &r.normal_laws, &r.tangential_laws, &r.rolling_laws, &r.solvers, &r.broad_phases,
                           &r.schemes, &r.measures})
    for (const auto& entry : *list) CHECK(text.find("\n  " + entry.name + " ") != std::string::npos);
  CHECK_THROWS_WITH(list_text(r, "shape"), "error: unknown kind 'shape'; did you mean 'shapes'?");
}

TEST_CASE("the JSON Schema names every table and key, and its brackets close", "[scenes][schema]") {
  const Registry r = test_registry();
  const std::string json = json_schema(r);
  for (const auto& table : make_schema(r).tables)
    for (const auto& field : table.fields) CHECK(json.find("\"" + field.name + "\":{") != std::string::npos);
  int depth = 0, lowest = 1;
  bool in_text = false;
  for (std::size_t k = 0; k + 1 < json.size(); ++k) {
    if (json[k] == '"' && json[k - 1] != '\\') in_text = !in_text;
    if (in_text) continue;
    depth += (json[k] == '{' || json[k] == '[') - (json[k] == '}' || json[k] == ']');
    if (k + 2 < json.size()) lowest = std::min(lowest, depth);
  }
  CHECK(depth == 0);
  CHECK(lowest == 1);  // one object from the first character to the last
  CHECK_FALSE(in_text);
}

TEST_CASE("numbers are printed as people write them", "[scenes][list]") {
  CHECK(format_number(1.7e6) == "1.7e6");
  CHECK(format_number(0.25) == "0.25");
  CHECK(format_number(-3) == "-3");
  CHECK(format_number(0.0) == "0");
  CHECK(format_number(1e-6) == "1e-6");
  CHECK(format_number(-2.5e-12) == "-2.5e-12");
  CHECK(format_number(infinity) == "inf");
  CHECK(format_range({0, 2, true, false}) == "(0, 2]");
  CHECK(format_range(not_negative) == "[0, inf)");
}

TEST_CASE("a value printed as TOML reads back as the same value", "[scenes][document]") {
  const std::string text = R"({"a" = [1, 2.5, true, "x \"y\" \\ z"], "b" = {"c" = "two"}})";
  const auto first = parse_document("v = " + text, "", {});
  REQUIRE(first.problems.empty());
  CHECK(to_toml(*first.root.find("v")) == text);
}
