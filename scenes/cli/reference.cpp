#include "scenes/cli/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "detection/narrow/pairs/pair_methods.h"
#include "scenes/cli/list.h"
#include "scenes/patch/patch_schema.h"
#include "scenes/reader/schema.h"
#include "scenes/reader/table_reader.h"

namespace epafi {
namespace {

constexpr const char* origin =
    "<!-- written by `epafi reference docs/reference --messages tests/data/broken`; edit the entry in the code, not "
    "this page -->\n";

std::string cell(std::string text) {  // a bar would end the cell
  for (std::size_t at = 0; (at = text.find('|', at)) != text.npos; at += 2) text.insert(at, "\\");
  return text;
}

const char* kind_name(Kind kind) {
  switch (kind) {
    case Kind::number:
      return "number";
    case Kind::integer:
      return "integer";
    case Kind::boolean:
      return "true or false";
    case Kind::text:
      return "text";
    case Kind::vec3:
      return "[x, y, z]";
    case Kind::quaternion:
      return "[w, x, y, z]";
    case Kind::numbers:
      return "list of numbers";
    case Kind::integers:
      return "integer or list";
    case Kind::vectors:
      return "list of [x, y, z]";
    case Kind::quadruples:
      return "list of [x, y, z, r]";
    case Kind::texts:
      return "text or list";
    case Kind::table:
      return "table";
    case Kind::shape:
      return "shape";
    case Kind::rows:
      return "list of rows";
    case Kind::load:
      return "[x, y, z] or table";
    case Kind::motions:
      return "table or list of tables";
    case Kind::bound:
      return "number or table";
    case Kind::tables:
      return "table";
  }
  return "";
}

std::string admissible(const Field& f) {
  if (!f.choices.empty()) {
    std::string all;
    for (const auto& c : f.choices) all += (all.empty() ? "" : ", ") + ("`" + c + "`");
    return all;
  }
  const bool limited = f.range.min != -infinity || f.range.max != infinity;
  return limited && f.kind != Kind::texts ? format_range(f.range) : "";
}

void add_fields(std::string& out, const std::vector<Field>& fields, const std::string& prefix) {
  for (const Field& f : fields) {
    if (f.kind == Kind::tables) continue;  // has a section of its own
    const std::string otherwise = f.default_value ? "`" + format_value(*f.default_value) + "`"
                                  : f.optional    ? "optional"
                                                  : "**required**";
    const char* kind = f.kind == Kind::table && !f.choices.empty() ? "word or table" : kind_name(f.kind);
    out += fmt::format("| `{}{}` | {} | {} | {} | {} | {} | {} |\n", prefix, f.name, cell(f.symbol), f.unit, kind,
                       otherwise, cell(admissible(f)), cell(f.help));
    if (f.kind == Kind::table || f.kind == Kind::motions) add_fields(out, f.fields, prefix + f.name + ".");
  }
}

constexpr const char* field_head =
    "| key | symbol | unit | kind | default | admissible | |\n|---|---|---|---|---|---|---|\n";

std::string field_table(const std::vector<Field>& fields) {
  if (fields.empty()) return "No parameters.\n";
  std::string out = field_head;
  add_fields(out, fields, "");
  return out;
}

std::string field_row(const Field& f) {
  std::string out;
  add_fields(out, {f}, "");
  return out;
}

std::string needs_text(const Needs& n) {
  std::string out;
  const auto add = [&](bool has, const char* name) {
    if (has) out += (out.empty() ? "" : ", ") + std::string(name);
  };
  add(n.rotation, "rotation");
  add(n.slip_velocity, "slip velocity");
  add(n.memory, "memory of each contact");
  add(n.curvature, "curvature");
  add(n.manifold, "several points per pair");
  add(n.contact_moment, "contact moment");
  add(n.area, "overlap area");
  return out;
}

std::string heading(const Entry& e) {
  std::string out = "\n### " + e.name + "\n" + e.summary + (e.source.empty() ? "" : " (" + e.source + ")") + ".\n";
  if (const std::string needs = needs_text(e.needs); !needs.empty()) out += "Asks for: " + needs + ".\n";
  return out + "\n";
}

std::string entries(const std::vector<Entry>& list, bool shapes = false) {
  std::string out;
  for (const Entry& e : list) out += heading(e) + field_table(shapes ? authoring_fields(e) : e.fields);
  return out;
}

/// Rows by key: of each key the one that most entries have, if at least three do.
std::map<std::string, std::string> find_shared_rows(const std::vector<Entry>& list) {
  std::map<std::string, std::map<std::string, int>> uses;
  for (const Entry& e : list)
    for (const Field& f : e.fields) ++uses[f.name][field_row(f)];
  std::map<std::string, std::string> shared;
  for (const auto& [name, rows] : uses) {
    const auto most =
        std::max_element(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most->second >= 3) shared[name] = most->first;
  }
  return shared;
}

/// Keys that several entries describe by the same words stand in one table before them.
std::string entries_with_shared_keys(const std::vector<Entry>& list) {
  const auto shared = find_shared_rows(list);
  std::string table, out;
  for (const Entry& e : list) {
    std::string own, also;
    for (const Field& f : e.fields) {
      const std::string row = field_row(f);
      const auto at = shared.find(f.name);
      if (at == shared.end() || at->second != row) {
        own += row;
        continue;
      }
      also += (also.empty() ? "" : ", ") + ("`" + f.name + "`");
      if (table.find(row) == table.npos) table += row;
    }
    out += heading(e);
    if (!own.empty()) out += field_head + own;
    if (!also.empty()) out += std::string(own.empty() ? "Shared keys: " : "\nAnd shared keys: ") + also + ".\n";
    if (e.fields.empty()) out += "No parameters.\n";
  }
  return table.empty() ? out : "\nShared keys; each entry names those that it takes:\n\n" + (field_head + table) + out;
}

std::string pair_matrix(const std::vector<Entry>& shapes) {
  std::string head = "| |", line = "|---|", rows;
  for (const Entry& b : shapes) {
    head += " " + b.name + " |";
    line += "---|";
  }
  for (const Entry& a : shapes) {
    rows += "| **" + a.name + "** |";
    for (const Entry& b : shapes) rows += std::string(" ") + pair_method(a.name, b.name) + " |";
    rows += "\n";
  }
  return head + "\n" + line + "\n" + rows;
}

const char* form_text(TableSchema::Form form) {
  switch (form) {
    case TableSchema::Form::single:
      return "one table";
    case TableSchema::Form::named:
      return "one table per name";
    case TableSchema::Form::list:
      return "any number, `[[...]]`";
    case TableSchema::Form::free:
      return "names are yours";
  }
  return "";
}

std::string keys_page(const Registry& registry) {
  std::string out = std::string(origin) +
                    "# Keys of a scene file\n\nNumbers are SI, a text with a unit (`\"10 mm\"`), or `\"= expression\"` "
                    "over `[params]` (and `seed`, that of `[run]`). "
                    "Parameters of laws and solvers stand on their own pages. Top level: `title` (text), `include` "
                    "(list of files merged below this one).\n";
  for (const TableSchema& t : make_schema(registry).tables) {
    const bool list = t.form == TableSchema::Form::list, named = t.form == TableSchema::Form::named;
    out += "\n## " + std::string(list ? "[[" : "[") + t.name + (named ? ".NAME" : "") + (list ? "]]" : "]") + "\n" +
           t.summary + "; " + form_text(t.form) + ".\n\n";
    if (t.form == TableSchema::Form::free) continue;
    if (t.name == "shape") {
      out += "One of the forms of [shapes.md](shapes.md), and:\n\n";
      std::vector<Field> own;
      for (const Field& f : t.fields)
        if (!find_entry(registry.shapes, f.name)) own.push_back(f);
      out += field_table(own);
    } else {
      out += field_table(t.fields);
    }
  }
  return out;
}

std::string patch_page(const Registry& registry) {
  return std::string(origin) + "# Keys of a patch case (`epafi patch`)\n\n## [patch]\n" + field_table(patch_fields()) +
         "\nThe profiles are shapes: [wheel_profile and rail_profile](shapes.md).\n\n## [contact]\n" +
         field_table(patch_contact_fields()) + "\n## [material.NAME]\n" + field_table(patch_material_fields()) +
         "\n## Normal models\n" + entries(registry.patch_normal_models) + "\n## Tangential models\n" +
         entries(registry.patch_tangential_models);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> reference_pages(const Registry& r) {
  const std::string top = origin;
  return {{"shapes.md", top + "# Shapes: `[shape.NAME]` or `shape = { ... }`\n" + entries(r.shapes, true) +
                            "\n## How each pair is found\n\n" + pair_matrix(r.shapes)},
          {"laws.md", top + "# Laws of smooth contact\n\n## Normal: `[contact.smooth] law`\n" +
                          entries_with_shared_keys(r.normal_laws) + "\n## Friction: `[contact.smooth] tangential`\n" +
                          entries(r.tangential_laws) + "\n## Rolling: `[contact.smooth] rolling`\n" +
                          entries(r.rolling_laws)},
          {"solvers.md", top + "# Solvers of non-smooth contact: `[contact.nonsmooth] solver`\n" +
                             entries_with_shared_keys(r.solvers)},
          {"measures.md", top + "# Measures: `[[measure]] kind`\n" + entries_with_shared_keys(r.measures)},
          {"stages.md", top + "# Broad phases and time schemes\n\n## `[detection] broad_phase`\n" +
                            entries(r.broad_phases) + "\n## `[run] scheme`\n" + entries(r.schemes)},
          {"keys.md", keys_page(r)},
          {"patch.md", patch_page(r)}};
}

std::string messages_page(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::directory_iterator(folder))
    if (file.path().extension() == ".toml") files.push_back(file.path());
  std::sort(files.begin(), files.end());
  std::string out = std::string(origin) +
                    "# Messages\n\nEach says place (line:column), what was found, and what to write instead. All "
                    "problems of a file come at once. "
                    "These come from scenes that are wrong on purpose; a test compares them word for word.\n\n| "
                    "message | scene |\n|---|---|\n";
  for (const auto& file : files) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line) && line.rfind("# expect: ", 0) == 0;)
      out += "| `" + cell(line.substr(10)) + "` | " + file.stem().string() + " |\n";
  }
  return out;
}

}  // namespace epafi
