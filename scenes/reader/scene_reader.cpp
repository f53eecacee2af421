#include "scenes/reader/scene_reader.h"

#include <algorithm>

#include "engine/nearest.h"
#include "scenes/reader/document.h"
#include "scenes/reader/file_kind.h"
#include "scenes/reader/parts.h"

namespace epafi {
namespace {

/// Names at the top of a file: those of tables without a dot, and `title`.
void check_top(Reading& reading) {
  std::vector<std::string> known{"title", "include"};
  for (const auto& table : reading.schema.tables)
    if (table.name.find('.') == std::string::npos) known.push_back(table.name);
  for (const auto& [key, place, value] : reading.root.members) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const bool list = value.is_array_of_tables();
    const std::string what = list                              ? "table [[" + key + "]]"
                             : value.type == Node::Type::table ? "table [" + key + "]"
                                                               : "key '" + key + "'";
    reading.error(value.type == Node::Type::table || list ? value.place : place,
                  "unknown " + what + suggestion(key, known, "known tables"));
  }
  const Node* title = reading.root.find("title");
  if (title && title->type != Node::Type::text)
    reading.error(title->place, std::string("title: expected a text, found ") + type_name(title->type));
}

/// The main file first, then others in the order they were met, then --set; inside a file by line.
void sort_by_place(std::vector<Problem>& problems, const std::string& main_file) {
  const auto rank = [&](const Problem& p) { return p.place.file == main_file ? 0 : is_override(p.place) ? 2 : 1; };
  std::stable_sort(problems.begin(), problems.end(), [&](const Problem& a, const Problem& b) {
    return std::tuple(rank(a), a.place.file, a.place.line, a.place.column) <
           std::tuple(rank(b), b.place.file, b.place.line, b.place.column);
  });
}

ReadResult read_document(Document document, const std::string& file, const Registry& registry) {
  ReadResult result;
  Reading reading(registry, document.root, file);
  reading.problems = std::move(document.problems);
  const bool whole = reading.problems.empty();
  if (!document.failed && !report_other_kind(reading, FileKind::scene)) {
    Draft draft{reading, {}, {}};
    draft.scene.file = file;
    draft.scene.text = std::move(document.text);
    if (const Node* title = reading.root.find("title")) draft.scene.title = title->text;
    check_top(reading);
    reading.check_params();
    for (const auto read :
         {read_run, read_world, read_materials, read_contact, read_detection, read_shapes, read_bodies, read_body_files,
          read_fills, read_outlets, read_springs, read_measures, read_bounds, read_studies, read_view, check_pairs}) {
      read(draft);
    }
    if (whole && reading.errors() == 0) result.scene = std::move(draft.scene);
  }
  result.problems = std::move(reading.problems);
  sort_by_place(result.problems, file);
  return result;
}

}  // namespace

ReadResult read_scene(const std::string& path, const std::vector<std::string>& overrides, const Registry& registry) {
  return read_document(load_document(path, overrides), path, registry);
}

ReadResult read_scene_text(const std::string& text, const std::string& file, const std::vector<std::string>& overrides,
                           const Registry& registry) {
  return read_document(parse_document(text, file, overrides), file, registry);
}

// --- shared by the parts

const Node* find_table(Reading& reading, const std::string& name) {
  const Node* node = &reading.root;
  for (std::size_t begin = 0; node && begin <= name.size();) {
    const std::size_t end = std::min(name.find('.', begin), name.size());
    if (node->type == Node::Type::table)
      node = node->find(name.substr(begin, end - begin));
    else
      return nullptr;  // the outer one has been reported
    begin = end + 1;
  }
  if (!node || node->type == Node::Type::table) return node;
  reading.error(node->place, "[" + name + "]: expected a table, found " + type_name(node->type));
  return nullptr;
}

const Node& table_or_empty(Reading& reading, const std::string& name) {
  static const Node empty;
  const Node* table = find_table(reading, name);
  return table ? *table : empty;
}

void each_item(Reading& reading, const std::string& name, const std::function<void(const Node&)>& visit) {
  const std::size_t dot = name.rfind('.');
  const Node* parent = dot == std::string::npos ? &reading.root : find_table(reading, name.substr(0, dot));
  const Node* list = parent ? parent->find(dot == std::string::npos ? name : name.substr(dot + 1)) : nullptr;
  if (!list) return;
  if (!list->is_array_of_tables() && !(list->type == Node::Type::array && list->items.empty())) {
    return reading.error(list->place, "[[" + name + "]]: expected a list of tables, found " + type_name(list->type) +
                                          "; write [[" + name + "]] above each");
  }
  for (const auto& item : list->items) visit(item);
}

std::string item_label(const std::string& name, const Node& item) {
  const Node* own = item.find("name");
  return "[[" + name + "]]" + (own && own->type == Node::Type::text ? " '" + own->text + "'" : "");
}

bool check_box(Reading& reading, const Vec3& min, const Vec3& max, const Place& place, const std::string& label) {
  for (int k = 0; k < 3; ++k) {
    if (min[k] < max[k]) continue;
    const char axis[] = {"xyz"[k], '\0'};
    reading.error(place, label + ": the box is empty along " + axis + ": min = " + format_number(min[k]) +
                             ", max = " + format_number(max[k]) + " (in m)");
    return false;
  }
  return true;
}

std::optional<Vec3> unit_vector(Reading& reading, const Vec3& direction, const Place& place, const std::string& label) {
  const double largest = direction.cwiseAbs().maxCoeff();
  if (largest > 0.0) return (direction / largest).normalized();
  reading.error(place, label + ": a vector of length 0 has no direction");
  return std::nullopt;
}

}  // namespace epafi
