#include "scenes/reader/toml_text.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <optional>
#include <sstream>

namespace epafi {
namespace {

Place place_of(const toml::source_region& region, const std::string& file) {
  return {file, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

Node convert(const toml::node& from, const std::string& file) {
  Node node;
  node.place = place_of(from.source(), file);
  if (const auto* table = from.as_table()) {
    for (const auto& [key, value] : *table)
      node.members.push_back({std::string(key.str()), place_of(key.source(), file), convert(value, file)});
    // toml++ sorts by key; messages and repeated reading need the order of the file
    std::stable_sort(node.members.begin(), node.members.end(), [](const Member& a, const Member& b) {
      return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
    });
  } else if (const auto* array = from.as_array()) {
    node.type = Node::Type::array;
    node.items.reserve(array->size());
    for (const auto& item : *array) node.items.push_back(convert(item, file));
  } else if (const auto* boolean = from.as_boolean()) {
    node.type = Node::Type::boolean;
    node.boolean = boolean->get();
  } else if (const auto* integer = from.as_integer()) {
    node.type = Node::Type::integer;
    node.integer = integer->get();
    node.real = static_cast<double>(node.integer);
  } else if (const auto* real = from.as_floating_point()) {
    node.type = Node::Type::real;
    node.real = real->get();
  } else if (const auto* text = from.as_string()) {
    node.type = Node::Type::text;
    node.text = text->get();
    node.quoted_inline = from.source().begin.line == from.source().end.line;
  } else {
    node.type = Node::Type::date;
    std::ostringstream out;
    from.visit([&](const auto& value) {
      if constexpr (toml::is_date<decltype(value)> || toml::is_time<decltype(value)> ||
                    toml::is_date_time<decltype(value)>)
        out << value.get();
    });
    node.text = out.str();
  }
  return node;
}

/// Place of a key or text with a NUL character, which would end file names and messages; empty where there is none.
std::optional<Place> zero_in(const Node& node) {
  if (node.text.find('\0') != std::string::npos) return node.place;
  for (const Node& item : node.items)
    if (auto found = zero_in(item)) return found;
  for (const Member& member : node.members) {
    if (member.key.find('\0') != std::string::npos) return member.place;
    if (auto found = zero_in(member.value)) return found;
  }
  return std::nullopt;
}

void move_to(Node& node, const Place& place) {
  node.place = place;
  node.quoted_inline = false;
  for (auto& item : node.items) move_to(item, place);
  for (auto& member : node.members) {
    member.place = place;
    move_to(member.value, place);
  }
}

}  // namespace

ParsedToml parse_toml(const std::string& text, const std::string& file) {
  try {
    Node root = convert(toml::parse(text, file), file);
    if (const auto zero = zero_in(root))
      return {{}, {Problem::Level::error, *zero, "the character U+0000 is no part of a text"}};
    return {std::move(root), {}};
  } catch (const toml::parse_error& e) {
    return {{}, {Problem::Level::error, place_of(e.source(), file), std::string(e.description())}};
  }
}

Node parse_toml_value(const std::string& text, const Place& place) {
  const std::string trimmed = text.substr(std::min(text.find_first_not_of(' '), text.size()));
  auto parsed = parse_toml("value = " + trimmed, "");
  Node node;
  if (parsed.problem.text.empty() && parsed.root.members.size() == 1) {
    node = std::move(parsed.root.members[0].value);
    if (node.type != Node::Type::text) node.text = trimmed;
  } else {
    node.type = Node::Type::text;
    node.text = trimmed;
  }
  move_to(node, place);
  return node;
}

std::string quote_toml(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + "\"";
}

}  // namespace epafi
