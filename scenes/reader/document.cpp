#include "scenes/reader/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/units/nearest.h"
#include "scenes/reader/toml_text.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t most_includes = 256;
constexpr std::uintmax_t largest_file = 64u << 20;  // [bytes]; larger data belongs in a CSV file
constexpr std::string_view override_prefix = "--set ";

struct Loader {
  Document document;
  std::vector<std::string> open;  ///< files being read, outermost first
  std::size_t files = 0;          ///< read so far

  void error(const Place& place, std::string text) {
    document.problems.push_back({Problem::Level::error, place, std::move(text)});
  }
  Node load(const std::string& path, const Place& from);
  Node parse(const std::string& text, const std::string& file);
  Node merge_includes(Node own);
  void apply(Node& root, const std::string& override_text);
  Node* step_into(Node& node, const std::string& key, const Place& place, bool last);
};

bool read_whole(const std::string& path, std::string& text, std::string& problem) {
  std::error_code failure;
  if (!fs::is_regular_file(path, failure)) {
    problem = fs::exists(path, failure) ? "is not a file" : "does not exist";
    return false;
  }
  if (fs::file_size(path, failure) > largest_file) {
    problem = "is larger than 64 MiB";
    return false;
  }
  std::ifstream in(path, std::ios::binary);
  std::ostringstream all;
  all << in.rdbuf();
  if (!in) {
    problem = "cannot be read";
    return false;
  }
  text = all.str();
  return true;
}

/// The included file with keys overridden by the including one.
Node merged(Node below, Node above) {
  for (auto& member : above.members) {
    const auto same =
        std::find_if(below.members.begin(), below.members.end(), [&](const Member& m) { return m.key == member.key; });
    if (same == below.members.end()) {
      below.members.push_back(std::move(member));
    } else if (same->value.type == Node::Type::table && member.value.type == Node::Type::table) {
      same->value = merged(std::move(same->value), std::move(member.value));
    } else if (same->value.is_array_of_tables() && member.value.is_array_of_tables()) {
      std::move(member.value.items.begin(), member.value.items.end(), std::back_inserter(same->value.items));
    } else {
      *same = std::move(member);
    }
  }
  below.place = above.place;
  return below;
}

Node Loader::load(const std::string& path, const Place& from) {
  std::string text, problem;
  const std::string canonical = fs::weakly_canonical(path).string();
  if (std::find(open.begin(), open.end(), canonical) != open.end()) {
    error(from, "the file '" + path + "' includes itself");
    return {};
  }
  if (++files > most_includes) {
    error(from, "more than 256 files are included");
    return {};
  }
  if (!read_whole(path, text, problem)) {
    error(from.file.empty() ? Place{path, 0, 0} : from,
          from.file.empty() ? "the scene file " + problem : "the file '" + path + "' " + problem);
    document.failed = true;
    return {};
  }
  open.push_back(canonical);
  Node node = parse(text, path);
  open.pop_back();
  return node;
}

Node Loader::parse(const std::string& text, const std::string& file) {
  document.text += text + "\n";
  auto parsed = parse_toml(text, file);
  if (!parsed.problem.text.empty()) {
    document.problems.push_back(parsed.problem);
    document.failed = true;
    return {};
  }
  return merge_includes(std::move(parsed.root));
}

Node Loader::merge_includes(Node own) {
  const Node* include = own.find("include");
  if (!include) return own;
  const auto is_text = [](const Node& n) { return n.type == Node::Type::text; };
  Node below;
  if (include->type == Node::Type::array && std::all_of(include->items.begin(), include->items.end(), is_text)) {
    for (const auto& item : include->items)
      below = merged(std::move(below), load(resolve_path(item.text, item.place, ""), item.place));
  } else {
    error(include->place, "include: expected a list of file names, found " + std::string(type_name(include->type)));
  }
  std::erase_if(own.members, [](const Member& m) { return m.key == "include"; });
  return merged(std::move(below), std::move(own));
}

/// The node at `key`; creates missing tables, so that an override can add a key.
Node* Loader::step_into(Node& node, const std::string& key, const Place& place, bool last) {
  if (node.type == Node::Type::table) {
    for (auto& member : node.members)
      if (member.key == key) return &(last ? (member.place = place, member.value) : member.value);
    node.members.push_back({key, place, {}});
    node.members.back().value.place = place;
    return &node.members.back().value;
  }
  if (node.type != Node::Type::array) {
    error(place, "there is nothing inside " + std::string(type_name(node.type)) + " to set '" + key + "' of");
    return nullptr;
  }
  std::vector<std::string> names;
  for (auto& item : node.items) {  // names first: one may be a number
    const Node* name = item.type == Node::Type::table ? item.find("name") : nullptr;
    if (!name) continue;
    if (name->text == key) return &item;
    names.push_back(name->text);
  }
  if (!key.empty() && key.size() < 10 && key.find_first_not_of("0123456789") == std::string::npos) {
    const auto index = static_cast<std::size_t>(std::stoul(key));
    if (index < node.items.size()) return &node.items[index];
    error(place, fmt::format("there is no element {}; the list has {}, counted from 0", index, node.items.size()));
    return nullptr;
  }
  error(place, "no element has the name '" + key + "'" + suggestion(key, names, "names"));
  return nullptr;
}

void Loader::apply(Node& root, const std::string& override_text) {
  const Place place{std::string(override_prefix) + override_text, 0, 0};
  const std::size_t equals = override_text.find('=');
  std::string path = override_text.substr(0, equals);
  while (!path.empty() && path.back() == ' ') path.pop_back();
  if (equals == std::string::npos || path.empty()) return error(place, "expected KEY.PATH=VALUE");
  Node value = parse_toml_value(override_text.substr(equals + 1), place);
  Node* at = &root;
  for (std::size_t begin = 0; at && begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    if (end == begin) return error(place, "the key path has an empty step");
    at = step_into(*at, path.substr(begin, end - begin), place, end == path.size());
    begin = end + 1;
  }
  if (at) *at = std::move(value);
  document.text += override_text + "\n";
}

Document finished(Loader&& loader, Node root, const std::vector<std::string>& overrides) {
  loader.document.root = std::move(root);
  if (!loader.document.failed)
    for (const auto& text : overrides) loader.apply(loader.document.root, text);
  return std::move(loader.document);
}

}  // namespace

const Node* Node::find(std::string_view key) const {
  for (const auto& member : members)
    if (member.key == key) return &member.value;
  return nullptr;
}

bool Node::is_array_of_tables() const {
  return type == Type::array && !items.empty() &&
         std::all_of(items.begin(), items.end(), [](const Node& n) { return n.type == Type::table; });
}

const char* type_name(Node::Type type) {
  constexpr const char* names[] = {"true or false", "an integer", "a number", "a text", "a date", "a list", "a table"};
  return names[static_cast<std::size_t>(type)];
}

std::string to_toml(const Node& node) {
  switch (node.type) {
    case Node::Type::boolean:
      return node.boolean ? "true" : "false";
    case Node::Type::integer:
      return std::to_string(node.integer);
    case Node::Type::real:
      return fmt::format("{}", node.real);
    case Node::Type::date:
      return node.text;
    case Node::Type::text:
      return quote_toml(node.text);
    case Node::Type::array: {
      std::string all;
      for (const auto& item : node.items) all += (all.empty() ? "" : ", ") + to_toml(item);
      return "[" + all + "]";
    }
    case Node::Type::table:
      break;
  }
  std::string all;
  for (const auto& m : node.members) all += (all.empty() ? "" : ", ") + quote_toml(m.key) + " = " + to_toml(m.value);
  return "{" + all + "}";
}

void set_value(Node& root, const std::string& override_text, std::vector<Problem>& problems) {
  Loader loader;
  loader.apply(root, override_text);
  problems.insert(problems.end(), loader.document.problems.begin(), loader.document.problems.end());
}

Document load_document(const std::string& path, const std::vector<std::string>& overrides) {
  Loader loader;
  Node root = loader.load(path, {});
  return finished(std::move(loader), std::move(root), overrides);
}

Document parse_document(const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
  Loader loader;
  Node root = loader.parse(text, file);
  return finished(std::move(loader), std::move(root), overrides);
}

std::string resolve_path(const std::string& name, const Place& place, const std::string& main_file) {
  const fs::path path(name);
  if (path.is_absolute()) return name;
  return (fs::path(is_override(place) ? main_file : place.file).parent_path() / path).lexically_normal().string();
}

bool is_override(const Place& place) { return place.file.compare(0, override_prefix.size(), override_prefix) == 0; }

}  // namespace epafi
