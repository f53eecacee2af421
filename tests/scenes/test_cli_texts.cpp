// What `epafi list` and `epafi schema` print.
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>

#include "detection/narrow/pairs/pair_methods.h"
#include "engine/units/error.h"
#include "scenes/cli/list.h"
#include "scenes/cli/manual.h"
#include "scenes/cli/reference.h"
#include "scenes/cli/schema_json.h"
#include "scenes/full_registry.h"
#include "scenes/reader/document.h"
#include "scenes/reader/schema.h"
#include "scenes/reader/table_reader.h"
#include "tests/support/catch.h"
#include "tests/support/scene_registry.h"
#include "viz_export/files/json_reader.h"

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

TEST_CASE("the list of pairs names each ordered pair once with its method, within 80 columns", "[scenes][list]") {
  const Registry& r = full_registry();
  std::istringstream lines(list_text(r, "pairs"));
  std::map<std::pair<std::string, std::string>, std::string> found;
  std::string line, shape, method;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    INFO(line);
    CHECK(line.size() <= 80);
    if (line.substr(0, 4) != "    ") {
      shape = line.substr(2);
      continue;
    }
    if (line[4] != ' ') method = line.substr(4, line.find(' ', 4) - 4);
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream names(line.substr(25));
    for (std::string name; names >> name;) CHECK(found.emplace(std::pair(shape, name), method).second);
  }
  CHECK(found.size() == r.shapes.size() * r.shapes.size());
  for (const auto& [pair, how] : found) {
    INFO(pair.first << " " << pair.second);
    CHECK(how == pair_method(pair.first, pair.second));
    CHECK(how == found[{pair.second, pair.first}]);
  }
}

/// What a shell line with the program in it prints, and its exit code.
std::pair<int, std::string> answer(const std::string& before, const std::string& after) {
  FILE* pipe = popen((before + std::string(EPAFI_BINARY_DIR) + "/bin/epafi " + after + " 2>&1").c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string said;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) said.push_back(static_cast<char>(c));
  return {WEXITSTATUS(pclose(pipe)), said};
}

TEST_CASE("a command that does not exist is answered with its name and the nearest one", "[scenes][list]") {
  const auto [code, said] = answer("", "rum scene.toml");
  CHECK(code == 2);
  CHECK(said.find("error: unknown command 'rum'; did you mean 'run'?") == 0);
}

TEST_CASE("help is a command too", "[scenes][list]") {
  CHECK(answer("", "help") == answer("", "--help"));
  CHECK(answer("", "help run") == answer("", "run --help"));
}

TEST_CASE("an option that does not exist, or is given no number of its kind, is answered with what is",
          "[scenes][list]") {
  const auto refused = [](const std::string& line, const std::string& text) {
    INFO(line);
    const auto [code, said] = answer("", line);
    CHECK(code == 2);
    CHECK_THAT(said, Catch::Contains(text));
  };
  refused("run scene.toml --treads 2", "error: unknown option '--treads' of epafi run; did you mean '--threads'?");
  refused("resume out --force", "error: unknown option '--force' of epafi resume");
  refused("run -t4", "error: scene is required");
  refused("new", "which starter scene? There are: ");
  refused("run scene.toml -t 0", "--threads: '0' is no whole number from 1 to 1000000000");
  refused("run scene.toml --steps -3", "--steps: '-3' is no whole number from 0");
  refused("run scene.toml --steps 1.5", "--steps: '1.5' is no whole number from 0");
  refused("run scene.toml --until -1", "--until: '-1' is no number of at least 0");
  refused("bench scene.toml --threads 1,x", "--threads: 'x' is no whole number from 1");
  refused("run " + std::string(EPAFI_SOURCE_DIR) + "/scenes/library/impact/bounce.toml -o /dev/null",
          "output folder '/dev/null' is a file");
}

TEST_CASE("what cannot be printed is said, with the code of files", "[scenes][list]") {
  for (const char* command : {"list", "schema", "new stack", "man"}) {
    INFO(command);
    const auto [code, said] = answer("(", std::string(command) + " >/dev/full)");
    CHECK(code == 3);
    CHECK_THAT(said, Catch::Contains("cannot write to standard output: No space left on device"));
  }
}

TEST_CASE("an instruction set that does not exist is refused, not replaced by the widest", "[scenes][list]") {
  const auto [code, said] = answer("EPAFI_TARGET=sse2 ", "list");
  CHECK(code == 2);
  CHECK(said.find("EPAFI_TARGET in the environment is 'sse2', no instruction set") != std::string::npos);
  CHECK(said.find("baseline is SSE2") != std::string::npos);
  CHECK(answer("EPAFI_TARGET=avx ", "list").second.find("did you mean 'avx2'?") != std::string::npos);
  CHECK(answer("EPAFI_TARGET=baseline ", "list").first == 0);
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

TEST_CASE("the reference pages and the schema in the tree are those of the registry", "[scenes][reference]") {
  // they are written by: epafi reference docs/reference --messages tests/data/broken; epafi schema >
  // scenes/scene.schema.json
  const std::string root = EPAFI_SOURCE_DIR;
  const auto text_of = [](const std::string& path) {
    std::ifstream in(path);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  for (const auto& [name, text] : reference_pages(full_registry())) {
    INFO(name);
    CHECK(text_of(root + "/docs/reference/" + name) == text);
  }
  CHECK(text_of(root + "/docs/reference/messages.md") == messages_page(root + "/tests/data/broken"));
  CHECK(text_of(root + "/scenes/scene.schema.json") == json_schema(full_registry()));
  CHECK(read_json(root + "/scenes/scene.schema.json").text("title") == "Epafi scene");  // it is JSON
}

TEST_CASE("manual and completion name every command and option", "[scenes]") {
  const ProgramText program{
      "x", {{"run", "simulate", {{"scene", "file", true, true}, {"-t,--threads", "how many", true, false}}}}};
  const std::string manual = manual_page(program), completion = bash_completion(program);
  CHECK(manual.find("\"epafi run \\fIscene\\fR\"") != std::string::npos);
  CHECK(manual.find("\\fB\\-t, \\-\\-threads\\fR \\fIvalue\\fR") != std::string::npos);
  CHECK(completion.find("run) options=\"--help -t --threads\"") != std::string::npos);
}
