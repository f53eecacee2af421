#include "scenes/reader/scene_reader.h"

#include <algorithm>

#include "engine/units/nearest.h"
#include "scenes/reader/document.h"
#include "scenes/reader/file_kind.h"
#include "scenes/reader/parts.h"

namespace epafi {
namespace {

/// Checks the names at the top of a file: `title`, `include` and tables.
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

/// Sorts by file (main file, others in the order of reading, --set), then by line.
void sort_by_place(std::vector<Problem>& problems, const std::string& main_file) {
  const auto rank = [&](const Problem& p) { return p.place.file == main_file ? 0 : is_override(p.place) ? 2 : 1; };
  std::stable_sort(problems.begin(), problems.end(), [&](const Problem& a, const Problem& b) {
    return std::tuple(rank(a), a.place.file, a.place.line, a.place.column) <
           std::tuple(rank(b), b.place.file, b.place.line, b.place.column);
  });
}

/// Reads the parts of one stage's scene, in the order of their dependences.
void read_parts(Draft& draft) {
  for (const auto read :
       {read_run,      read_stages, read_world,      read_materials, read_contact,      read_detection, read_shapes,
        read_start,    read_bodies, read_body_files, read_fills,     read_stage_bodies, read_outlets,   read_springs,
        read_measures, read_bounds, check_stage,     read_studies,   read_view,         check_pairs}) {
    read(draft);
  }
}

bool is_known(const std::vector<Problem>& all, const Problem& p) {
  return std::any_of(all.begin(), all.end(), [&](const Problem& q) {
    return q.text == p.text && q.place.file == p.place.file && q.place.line == p.place.line &&
           q.place.column == p.place.column;
  });
}

/// Problems of all stages, each reported once.
void append_new(std::vector<Problem>& all, const std::vector<Problem>& more) {
  for (const Problem& p : more)
    if (!is_known(all, p)) all.push_back(p);
}

/// Source from which all stages are read.
struct StageSource {
  Node root;
  std::vector<Node> stages;  ///< none: the scene has no [[stage]]
  std::string file, text;
  const Registry& registry;
  ReadOptions options;
  std::shared_ptr<MadeRun> made{};   ///< that the scene starts from
  std::vector<std::string> files{};  ///< read so far
  std::vector<Problem> found{};      ///< of the stages read so far, before any was blamed
};

/// What a stage does to tables above it is found there, but it is the stage that has to be mended. Its own tables name
/// their lines.
void blame_stage(const Node& stage, std::size_t number, std::vector<Problem>& problems) {
  for (Problem& p : problems) {
    const bool own = p.place.file != stage.place.file || p.place.line >= stage.place.line;
    if (own || p.level != Problem::Level::error || p.text.starts_with("[[stage]]")) continue;
    p.text = stage_label(stage, number) + ": " + p.text;
    p.place = stage.place;
  }
}

/// One stage; the scene is empty where it has an error.
std::optional<Scene> read_stage_of(StageSource& from, std::size_t stage, std::vector<Problem>& problems) {
  std::vector<Problem> own;
  StageDocument merged;
  if (!from.stages.empty()) merged = document_of_stage(from.root, from.stages, stage, own);
  const Node& root = from.stages.empty() ? from.root : merged.root;
  Reading reading(from.registry, root, from.file);
  const bool whole = own.empty();
  reading.problems = std::move(own);
  Draft draft{reading, {}, {}};
  draft.stages = &from.stages;
  draft.stage = stage;
  draft.body_changes = std::move(merged.bodies);
  draft.start_run = from.options.start_run;
  draft.made = &from.made;
  draft.scene.file = from.file;
  draft.scene.text = from.text;
  for (std::size_t k = 0; k <= stage && k < from.stages.size(); ++k)
    if (const Node* world = from.stages[k].find("world"); world && world->find("gravity")) draft.stage_of_gravity = k;
  if (const Node* title = root.find("title")) draft.scene.title = title->text;
  check_top(reading);
  reading.check_params();
  read_parts(draft);
  const bool sound = whole && reading.errors() == 0;
  std::erase_if(reading.problems, [&](const Problem& p) { return is_known(from.found, p); });
  append_new(from.found, reading.problems);
  if (stage > 0) blame_stage(from.stages[stage], stage, reading.problems);
  append_new(problems, reading.problems);
  for (const std::string& file : reading.files)
    if (std::ranges::find(from.files, file) == from.files.end()) from.files.push_back(file);
  return sound ? std::optional(std::move(draft.scene)) : std::nullopt;
}

/// Function that reads any stage later.
std::function<Scene(std::size_t)> reader_of(std::shared_ptr<StageSource> source) {
  return [source = std::move(source)](std::size_t stage) {
    std::vector<Problem> problems;
    auto scene = read_stage_of(*source, stage, problems);
    if (!scene) throw SceneError(problems);
    scene->stage_of = reader_of(source);
    return std::move(*scene);
  };
}

/// Files read, without those of shapes of the first stage, which are hashed with their parameters.
std::vector<std::string> files_beside_shapes(const Scene& scene, std::vector<std::string> files) {
  std::erase_if(files, [&](const std::string& file) {
    return std::ranges::any_of(scene.shapes, [&](const ShapeSpec& shape) {
      const auto is_named = [&](const char* key) {
        return shape.parameters.has(key) && shape.parameters.text(key) == file;
      };
      return is_named("file") || is_named("irregularity.file");
    });
  });
  return files;
}

ReadResult read_document(Document document, const std::string& file, const Registry& registry,
                         const ReadOptions& options) {
  ReadResult result;
  result.problems = std::move(document.problems);
  std::vector<Problem> other_kind;
  {
    Reading kind(registry, document.root, file);
    document.failed = document.failed || report_other_kind(kind, FileKind::scene);
    other_kind = kind.problems;
  }
  if (!document.failed) {
    const auto source = std::make_shared<StageSource>(
        StageSource{std::move(document.root), {}, file, std::move(document.text), registry, options});
    source->stages = list_stages(source->root, options.inserted, result.problems);
    bool sound = result.problems.empty();
    const std::size_t count = std::max<std::size_t>(1, source->stages.size());
    for (std::size_t k = 0; k < count; ++k) {
      const bool wanted = k == options.stage;
      if (!wanted && options.stage > 0) continue;  // they were read when the run began
      auto scene = read_stage_of(*source, k, result.problems);
      sound = sound && scene.has_value();
      if (wanted) result.scene = std::move(scene);
    }
    if (!sound) result.scene.reset();
    if (result.scene) result.scene->files = files_beside_shapes(*result.scene, source->files);
    if (result.scene && count > 1) result.scene->stage_of = reader_of(source);
  }
  append_new(result.problems, other_kind);
  sort_by_place(result.problems, file);
  return result;
}

}  // namespace

ReadResult read_scene(const std::string& path, const std::vector<std::string>& overrides, const Registry& registry,
                      const ReadOptions& options) {
  return read_document(load_document(path, overrides), path, registry, options);
}

ReadResult read_scene_text(const std::string& text, const std::string& file, const std::vector<std::string>& overrides,
                           const Registry& registry, const ReadOptions& options) {
  return read_document(parse_document(text, file, overrides), file, registry, options);
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
