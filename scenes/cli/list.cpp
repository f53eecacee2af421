#include "scenes/cli/list.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "detection/narrow/pairs/pair_methods.h"
#include "engine/units/error.h"
#include "engine/units/nearest.h"
#include "scenes/reader/schema.h"
#include "scenes/reader/table_reader.h"
#include "scenes/wrapped_text.h"

namespace epafi {
namespace {

struct Part {
  const char* kind;
  const char* title;
  const std::vector<Entry>& entries;
};

bool is_limited(const Range& range) { return !(range.min == -infinity && range.max == infinity); }

void append_fields(std::string& out, const std::vector<Field>& fields, const std::string& prefix) {
  for (const auto& field : fields) {
    if (field.kind == Kind::table || field.kind == Kind::motions) {
      append_fields(out, field.fields, prefix + field.name + ".");
      continue;
    }
    const bool list = field.kind == Kind::texts;  // its range is that of the length
    std::string about = field.symbol;
    if (!field.unit.empty()) about += (about.empty() ? "" : " ") + ("[" + field.unit + "]");
    std::string line = fmt::format("    {:<24}{:<18}{}", prefix + field.name, about, field.help);
    if (is_limited(field.range) && !list) line += ", in " + format_range(field.range);
    if (field.default_value)
      line += ", default " + format_value(*field.default_value);
    else
      line += field.optional ? ", optional" : ", required";
    out += line + "\n";
  }
}

void append_part(std::string& out, const Part& part) {
  out += (out.empty() ? "" : "\n") + std::string(part.title) + "\n";
  for (const auto& entry : part.entries) {
    out +=
        fmt::format("  {:<24}{}{}\n", entry.name, entry.summary, entry.source.empty() ? "" : " (" + entry.source + ")");
    append_fields(out, std::string_view(part.kind) == "shapes" ? authoring_fields(entry) : entry.fields, "");
  }
}

/// The pair table: for each shape its methods, and the other shapes that each of them is for. Fits 80 columns.
void append_pairs(std::string& out, const std::vector<Entry>& shapes) {
  constexpr std::size_t width = 54;
  out += (out.empty() ? "" : "\n") + std::string("pairs of shapes and how they are found (none: they never touch)\n");
  for (const auto& a : shapes) {
    std::map<std::string, std::string> others;
    for (const auto& b : shapes) {
      std::string& names = others[pair_method(a.name, b.name)];
      names += (names.empty() ? "" : ", ") + b.name;
    }
    out += "  " + a.name + "\n";
    for (const auto& [method, names] : others) {
      const std::vector<std::string> lines = wrapped(names, width);
      for (std::size_t k = 0; k < lines.size(); ++k)
        out += fmt::format("    {:<20} {}\n", k == 0 ? method : "", lines[k]);
    }
  }
}

}  // namespace

const std::vector<std::string>& list_kinds() {
  static const std::vector<std::string> kinds{"shapes",   "laws",         "solvers", "broad_phases", "schemes",
                                              "measures", "patch_models", "scenes",  "pairs"};
  return kinds;
}

std::string list_text(const Registry& registry, std::string_view kind) {
  const Part parts[] = {{"shapes", "shapes: [shape.NAME] or shape = { ... }", registry.shapes},
                        {"laws", "normal laws: [contact.smooth] law", registry.normal_laws},
                        {"laws", "tangential laws: [contact.smooth] tangential", registry.tangential_laws},
                        {"laws", "rolling laws: [contact.smooth] rolling", registry.rolling_laws},
                        {"solvers", "solvers: [contact.nonsmooth] solver", registry.solvers},
                        {"broad_phases", "broad phases: [detection] broad_phase", registry.broad_phases},
                        {"schemes", "schemes: [run] scheme", registry.schemes},
                        {"measures", "measures: [[measure]] kind", registry.measures},
                        {"patch_models", "normal models: [patch] normal", registry.patch_normal_models},
                        {"patch_models", "tangential models: [patch] tangential", registry.patch_tangential_models}};
  const auto& kinds = list_kinds();
  if (!kind.empty() && std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
    throw SceneError("unknown kind '" + std::string(kind) + "'" + suggestion(kind, kinds, "kinds"));
  }
  std::string out;
  for (const auto& part : parts)
    if (kind.empty() || kind == part.kind) append_part(out, part);
  if (kind.empty() || kind == "pairs") append_pairs(out, registry.shapes);
  return out;
}

std::string format_value(const Value& value) {
  const auto join = [](const auto& items, auto&& one) {
    std::string all;
    for (const auto& item : items) all += (all.empty() ? "" : ", ") + one(item);
    return "[" + all + "]";
  };
  const auto vector = [&](const Vec3& v) { return join(std::vector<double>{v.x(), v.y(), v.z()}, format_number); };
  struct Format {
    decltype(join)& list;
    decltype(vector)& triple;
    std::string operator()(double v) const { return format_number(v); }
    std::string operator()(bool v) const { return v ? "true" : "false"; }
    std::string operator()(const std::string& v) const { return v; }
    std::string operator()(const Vec3& v) const { return triple(v); }
    std::string operator()(const std::vector<double>& v) const { return list(v, format_number); }
    std::string operator()(const std::vector<Vec3>& v) const { return list(v, triple); }
    std::string operator()(const std::vector<std::string>& v) const {
      return list(v, [](const std::string& s) { return s; });
    }
  };
  return std::visit(Format{join, vector}, value);
}

}  // namespace epafi
