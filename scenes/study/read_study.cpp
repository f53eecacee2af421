#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/units/units.h"
#include "scenes/full_registry.h"
#include "scenes/reader/expression.h"
#include "scenes/reader/file_kind.h"
#include "scenes/reader/table_reader.h"
#include "scenes/stop.h"
#include "scenes/study/study.h"

namespace epafi {
namespace {

constexpr std::size_t most_cases = 10000;  // of one vary table: a larger product is a slip of the pen

Field field(std::string name, Kind kind, std::string help, std::optional<Value> otherwise = {}) {
  Field f{std::move(name), "", "", kind, std::move(otherwise), {}, std::move(help)};
  f.optional = !f.default_value;
  return f;
}

/// Keys read here by hand, because their names are the user's; the rest by fields.
bool is_free_table(const std::string& key) {
  static const std::vector<std::string> free{"vary",       "reference", "set",  "fails_when", "parameter",
                                             "parameters", "error",     "axis", "again"};
  return std::find(free.begin(), free.end(), key) != free.end();
}

struct StudyReader {
  Reading reading;
  Study study;
  explicit StudyReader(const Document& document, const std::string& file)
      : reading(full_registry(), document.root, file) {
    study.file = file;
  }

  /// Leaves of nested tables as dotted keys.
  void leaves(const Node& table, const std::string& prefix, std::vector<std::pair<std::string, const Node*>>& out) {
    for (const auto& [key, place, value] : table.members) {
      const std::string path = prefix.empty() ? key : prefix + "." + key;
      if (value.type == Node::Type::table)
        leaves(value, path, out);
      else
        out.emplace_back(path, &value);
    }
  }

  std::vector<std::string> overrides_of(const Node& table) {
    std::vector<std::pair<std::string, const Node*>> all;
    leaves(table, "", all);
    std::vector<std::string> out;
    for (const auto& [key, value] : all) out.push_back(key + "=" + to_toml(*value));
    return out;
  }

  static std::string method_name(const std::vector<std::string>& overrides) {
    for (const char* key : {"contact.nonsmooth.solver=", "contact.smooth.law=", "contact.method=",
                            "detection.broad_phase=", "run.scheme="})
      for (const auto& o : overrides)
        if (o.compare(0, std::string_view(key).size(), key) == 0) {
          std::string name = o.substr(std::string_view(key).size());
          std::erase(name, '"');
          return name;
        }
    return overrides.empty() ? "scene" : overrides.front();
  }

  /// Every combination of the lists of one table of `vary`.
  void read_method(const Node& table) {
    if (table.type != Node::Type::table)
      return reading.error(table.place, std::string("vary: expected a table, found ") + type_name(table.type));
    std::vector<std::pair<std::string, const Node*>> all;
    leaves(table, "", all);
    std::string name;
    std::vector<std::vector<std::string>> combinations{{}};
    for (const auto& [key, value] : all) {
      if (key == "name") {
        name = value->text;
        continue;
      }
      const bool list = value->type == Node::Type::array;
      if (list && value->items.empty()) return reading.error(value->place, "vary '" + key + "': the list is empty");
      std::vector<std::vector<std::string>> longer;
      for (const auto& before : combinations)
        for (std::size_t k = 0; k < (list ? value->items.size() : 1); ++k) {
          longer.push_back(before);
          longer.back().push_back(key + "=" + to_toml(list ? value->items[k] : *value));
        }
      combinations = std::move(longer);
      if (combinations.size() > most_cases)
        return reading.error(table.place, "vary: more than 10000 cases in one table");
    }
    for (auto& overrides : combinations)
      study.methods.push_back({name.empty() ? method_name(overrides) : name, std::move(overrides)});
  }

  void read_errors(const Node& node) {
    if (node.type != Node::Type::array) return read_error(node, study.error);
    if (node.items.empty()) return reading.error(node.place, "error: the list is empty");
    study.more_errors.resize(node.items.size() - 1);
    for (std::size_t k = 0; k < node.items.size(); ++k)
      read_error(node.items[k], k == 0 ? study.error : study.more_errors[k - 1]);
  }

  void read_error(const Node& node, ErrorSpec& error) {
    if (node.type == Node::Type::text) {
      error.name = node.text;
      error.place = node.place;
      return;
    }
    if (node.type != Node::Type::table)
      return reading.error(node.place, std::string("error: expected a text or a table, found ") + type_name(node.type));
    Field statistic = field("statistic", Kind::text, "", Value(std::string("last")));
    statistic.choices = {"last", "min", "max"};
    Field name = field("measure", Kind::text, "");
    name.optional = false;
    const TableValues v =
        read_table(node, "error",
                   {name, field("component", Kind::text, ""), statistic, field("exact", Kind::number, ""),
                    field("relative", Kind::boolean, "", Value(false)), field("label", Kind::text, "")},
                   reading);
    if (!v.has("measure")) return;
    const auto word = [&](const char* key) { return v.has(key) ? v.text(key) : std::string{}; };
    error = {v.text("measure"),     word("component"), v.text("statistic"), v.optional_number("exact"),
             v.boolean("relative"), word("label"),     node.place};
  }

  void read_axis(const Node& node) {
    if (node.type != Node::Type::table)
      return reading.error(node.place, std::string("axis: expected a table, found ") + type_name(node.type));
    Field key = field("key", Kind::text, "");
    key.optional = false;
    const TableValues v = read_table(node, "axis", {key, field("label", Kind::text, "")}, reading);
    if (v.has("key")) {
      study.axis = v.text("key");
      study.axis_label = v.text(v.has("label") ? "label" : "key");
    }
  }

  void read_parameter(const Node& node) {
    if (node.type != Node::Type::table)
      return reading.error(node.place, std::string("parameter: expected a table, found ") + type_name(node.type));
    Field key = field("key", Kind::text, "");
    key.optional = false;
    Field scale = field("scale", Kind::text, "", Value(std::string("linear"))),
          search = field("search", Kind::text, "", Value(std::string("scan")));
    scale.choices = {"linear", "log"};
    search.choices = {"scan", "bisect"};
    Field count = field("count", Kind::integer, "", Value(10.0));
    count.range = {2, 1000};
    const TableValues v =
        read_table(node, "parameter",
                   {key, field("from", Kind::number, ""), field("to", Kind::number, ""), scale, search, count,
                    field("values", Kind::numbers, ""), field("integer", Kind::boolean, "", Value(false)),
                    field("tolerance", Kind::number, "", Value(0.02)), field("label", Kind::text, "")},
                   reading);
    if (!v.has("key")) return;
    ParameterSpec p{v.text("key"),
                    {},
                    v.text("search") == "bisect",
                    v.text("scale") == "log",
                    v.boolean("integer"),
                    v.number("tolerance"),
                    v.has("label") ? v.text("label") : v.text("key")};
    if (v.has("values"))
      p.values = v.numbers("values");
    else if (!v.has("from") || !v.has("to"))
      return reading.error(node.place, "parameter '" + p.key + "' needs from and to, or values");
    else {
      const double from = v.number("from"), to = v.number("to");
      if (!(from < to) || (p.log && from <= 0))
        return reading.error(node.place,
                             "parameter '" + p.key + "': from < to is needed, and from > 0 where scale = \"log\"");
      const auto n = static_cast<std::size_t>(p.bisect ? 2 : v.integer("count"));
      for (std::size_t k = 0; k < n; ++k) {
        const double s = static_cast<double>(k) / static_cast<double>(n - 1);
        p.values.push_back(p.log ? from * std::pow(to / from, s) : from + (to - from) * s);
      }
    }
    if (p.integer)
      for (double& x : p.values) x = std::round(x);
    study.parameters.push_back(std::move(p));
  }

  void read_failures(const Node& table) {
    std::vector<std::pair<std::string, const Node*>> all;
    leaves(table, "", all);
    for (const auto& [key, value] : all)
      if (const auto limit = reading.number(*value, std::string(any_unit), "fails_when " + key))
        study.fails_when.push_back({key, *limit});
  }

  void read_table_of(const std::string& key, const Node& value) {
    if (key == "error") read_errors(value);
    if (key == "axis") read_axis(value);
    if (key == "again") {
      study.again = overrides_of(value);
      study.has_again = true;
    }
    if (key == "reference") {
      study.reference = overrides_of(value);
      study.has_reference = true;
    }
    if (key == "set") study.fixed = overrides_of(value);
    if (key == "fails_when") read_failures(value);
    if (key == "parameter") read_parameter(value);
    if (key == "parameters" || key == "vary") {
      if (value.type != Node::Type::array) {
        reading.error(value.place, key + ": expected a list of tables");
        return;
      }
      for (const auto& item : value.items) key == "vary" ? read_method(item) : read_parameter(item);
    }
  }

  void read(const Node& root) {
    Node plain = root;
    std::erase_if(plain.members, [](const Member& m) { return is_free_table(m.key); });
    Field scene = field("scene", Kind::text, "the scene file");
    scene.optional = false;
    Field repeats = field("repeats", Kind::integer, "", Value(3.0)),
          threads = field("threads", Kind::integer, "", Value(1.0));
    repeats.range = {1, 100};
    threads.range = {1, 4096};
    Field cost = field("cost", Kind::text, "", Value(std::string("run")));
    cost.choices = {"run", "broad-phase"};
    const TableValues v = read_table(
        plain, "study",
        {scene, field("title", Kind::text, ""), field("theory", Kind::text, ""), field("theory_label", Kind::text, ""),
         field("time_limit", Kind::text, "", Value(std::string("60s"))), repeats, threads, cost,
         field("accuracy", Kind::number, "")},
        reading);
    if (!v.has("scene")) return;
    study.scene = resolve_path(v.text("scene"), v.place_of("scene"), study.file);
    const auto text = [&](const char* key) { return v.has(key) ? v.text(key) : std::string{}; };
    study.title = text("title");
    study.theory = text("theory");
    study.theory_label = text("theory_label");
    study.accuracy = v.optional_number("accuracy");
    study.cost = v.text("cost") == "run" ? Study::Cost::run : Study::Cost::broad_phase;
    study.repeats = static_cast<int>(v.integer("repeats"));
    study.threads = static_cast<int>(v.integer("threads"));
    if (const auto limit = parse_duration(v.text("time_limit")))
      study.time_limit = *limit;
    else
      reading.error(v.place_of("time_limit"),
                    "time_limit '" + v.text("time_limit") + "' is no duration; write 90s, 30m or 3h50m");
    for (const auto& [key, place, value] : root.members) read_table_of(key, value);
  }
};

}  // namespace

std::string csv_text(std::string text) {
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, "\"");
  return "\"" + text + "\"";
}

std::string ErrorSpec::axis_label() const {
  if (!label.empty()) return label;
  if (name == "overlap") return "deepest overlap / bounding radius";
  if (name == "energy") return "error of the energy balance / energy";
  if (name == "residual") return "largest residual";
  if (name == "momentum") return "change of momentum / momentum";
  if (name == "distance") return "distance of the bodies from the reference [m]";
  if (name == "depth") return "error of distance or depth / size and coordinates";
  return std::string(relative ? "relative error: " : "error: ") + name + (component.empty() ? "" : ", " + component);
}

void ErrorSpec::refuse(const std::string& study_file, const std::string& known) const {
  if (place.line == 0) throw SceneError("missing key 'error': write " + known, {study_file, 1, 1});
  throw SceneError("unknown error '" + name + "'; write " + known, place);
}

std::string StudyMethod::settings() const {
  std::string all;
  for (const auto& o : overrides) all += (all.empty() ? "" : "; ") + o;
  return all;
}

Study read_study(const std::string& path, const std::vector<std::string>& overrides) {
  const Document document = load_document(path, overrides);
  StudyReader reader(document, path);
  reader.reading.problems = document.problems;
  if (!document.failed && !report_other_kind(reader.reading, FileKind::study)) reader.read(document.root);
  const auto& problems = reader.reading.problems;
  if (std::any_of(problems.begin(), problems.end(), [](const Problem& p) { return p.level == Problem::Level::error; }))
    throw SceneError(problems);
  return std::move(reader.study);
}

}  // namespace epafi
