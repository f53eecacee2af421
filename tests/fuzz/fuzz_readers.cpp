// libFuzzer target for every reader; FUZZ=scene, mesh, problem or run chooses. Scene files are changed by grammar:
// keys, tables and values of the schema are put where they belong and where they do not. See run.sh.
#include <cstdint>
#include <cstring>
#include <random>

#include "scenes/reader/schema.h"
#include "tests/fuzz/feeds.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using namespace epafi;
using Lines = std::vector<std::string>;

enum class Reader { scene, mesh, problem, run };

Reader reader() {
  static const Reader chosen = [] {
    const char* name = std::getenv("FUZZ");
    const std::string_view text = name ? name : "";
    if (text == "scene") return Reader::scene;
    if (text == "mesh") return Reader::mesh;
    if (text == "problem") return Reader::problem;
    if (text == "run") return Reader::run;
    std::fprintf(stderr, "set FUZZ to scene, mesh, problem or run\n");
    std::exit(2);
  }();
  return chosen;
}

struct Words {
  std::vector<std::string> tables, keys, values;
};

constexpr const char* odd_values[] = {"0",
                                      "-1",
                                      "1",
                                      "2",
                                      "1e-300",
                                      "1e300",
                                      "-0.0",
                                      "inf",
                                      "nan",
                                      "9223372036854775807",
                                      "1e-9",
                                      "true",
                                      "\"\"",
                                      "[]",
                                      "{}",
                                      "[0, 0, 1]",
                                      "[1, 2]",
                                      "[[0,0,0],[1,0,0],[0,1,0],[0,0,1]]",
                                      "\"= 1/0\"",
                                      "\"= 2*(pi + i)\"",
                                      "\"= d\"",
                                      "\"10 mm\"",
                                      "\"5 GPa\"",
                                      "\"3 parsec\"",
                                      "\"steel\"",
                                      "\"a\"",
                                      "\"auto\"",
                                      "1979-05-27",
                                      "\"../../etc/passwd\"",
                                      "\"/dev/zero\"",
                                      "{ sphere = { radius = 0.01 } }",
                                      "{ box = { size = [1, 1, 1] } }",
                                      "{ half_space = { normal = [0, 0, 1] } }",
                                      "{ polyhedron = { random = { vertices = 12, seed = 3 } } }",
                                      "{ capsule = { radius = 1, length = 2 } }",
                                      "\"= min(max(1,2),sqrt(3))^-2^2\"",
                                      "\"= ((((((((((1))))))))))\"",
                                      "[0.5, \"= i\", 1e3]",
                                      "\"\\u0000\\ud7ff\""};

const Words& words() {
  static const Words all = [] {
    Words w;
    const Registry& registry = full_registry();
    for (const auto& table : make_schema(registry).tables) {
      w.tables.push_back("[" + table.name + (table.form == TableSchema::Form::named ? ".a]" : "]"));
      w.tables.push_back("[[" + table.name + "]]");
      for (const auto& f : table.fields) w.keys.push_back(f.name);
    }
    const auto take = [&](const std::vector<Entry>& entries) {
      for (const auto& e : entries) {
        w.values.push_back("\"" + e.name + "\"");
        w.keys.push_back(e.name);
        for (const auto& f : e.fields) w.keys.push_back(f.name);
      }
    };
    for (const auto* list : {&registry.shapes, &registry.normal_laws, &registry.tangential_laws, &registry.rolling_laws,
                             &registry.solvers, &registry.broad_phases, &registry.schemes, &registry.measures})
      take(*list);
    w.values.insert(w.values.end(), std::begin(odd_values), std::end(odd_values));
    return w;
  }();
  return all;
}

Lines split(std::string_view text) {
  Lines lines;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// One change that knows what a scene is made of.
void change(Lines& lines, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % std::max<std::size_t>(n, 1)); };
  const auto one = [&](const std::vector<std::string>& list) { return list[below(list.size())]; };
  if (lines.empty()) lines.emplace_back();
  const std::size_t at = below(lines.size());
  std::string& line = lines[at];
  const std::size_t equals = line.find('=');
  const std::string value = one(words().values);
  switch (below(9)) {
    case 0:
      if (equals != line.npos) line = line.substr(0, equals + 1) + " " + value;
      break;
    case 1:
      if (equals != line.npos) line = one(words().keys) + " " + line.substr(equals);
      break;
    case 2:
      lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at), one(words().keys) + " = " + value);
      break;
    case 3:
      lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at), one(words().tables));
      break;
    case 4:
      lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 5:
      lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(below(lines.size())), std::string(line));
      break;
    case 6:
      std::swap(line, lines[below(lines.size())]);
      break;
    case 7: {  // a number in the line becomes another
      const auto digit = line.find_first_of("0123456789", below(line.size() + 1));
      if (digit != line.npos) line.replace(digit, line.find_first_not_of("0123456789.e+-", digit) - digit, value);
      break;
    }
    default: {  // inside an inline table or list
      const auto comma = line.find_first_of(",{[", below(line.size() + 1));
      if (comma != line.npos) line.insert(comma + 1, " " + one(words().keys) + " = " + value + ", ");
    }
  }
}

/// HDF5 files are mostly holes: bytes that say something are found from a random place on.
void change_binary(std::uint8_t* data, std::size_t size, std::mt19937& random) {
  constexpr std::uint8_t telling[] = {0, 1, 2, 0x7f, 0x80, 0xfe, 0xff};
  for (unsigned n = 1 + static_cast<unsigned>(random() % 4); n > 0; --n) {
    std::size_t at = random() % size;
    for (std::size_t looked = 0; looked < size && data[at] == 0; ++looked) at = (at + 1) % size;
    at = std::min(size - 1, at + random() % 8);
    data[at] = random() % 2 == 0   ? telling[random() % std::size(telling)]
               : random() % 2 == 0 ? static_cast<std::uint8_t>(random())
                                   : static_cast<std::uint8_t>(data[at] ^ (1u << (random() % 8)));
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  std::mt19937 random(seed);
  if ((reader() == Reader::run || reader() == Reader::problem) && size > 0 && random() % 4 != 0) {
    change_binary(data, size, random);
    return size;
  }
  if (reader() != Reader::scene || random() % 4 == 0) return LLVMFuzzerMutate(data, size, max_size);
  Lines lines = split({reinterpret_cast<const char*>(data), size});
  for (unsigned n = 1 + static_cast<unsigned>(random() % 3); n > 0; --n) change(lines, random);
  std::string text;
  for (const auto& l : lines) text += l + "\n";
  const std::size_t length = std::min(text.size(), max_size);
  std::memcpy(data, text.data(), length);
  return length;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  switch (reader()) {
    case Reader::scene:
      (void)fuzz::feed_scene(bytes);
      return 0;
    case Reader::mesh:
      (void)fuzz::feed_mesh(bytes);
      return 0;
    case Reader::problem:
      (void)fuzz::feed_problem(bytes);
      return 0;
    case Reader::run:
      (void)fuzz::feed_run(bytes);
      return 0;
  }
  return 0;
}
