#include "viz_export/files/json_reader.h"

#include <nlohmann/json.hpp>

#include "engine/units/error.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

void flatten(const nlohmann::json& node, const std::string& name, FlatJson& out) {
  const auto inside = [&](const std::string& key) { return name.empty() ? key : name + "." + key; };
  if (node.is_object())
    for (const auto& [key, value] : node.items()) flatten(value, inside(key), out);
  else if (node.is_array())
    for (std::size_t i = 0; i < node.size(); ++i) flatten(node[i], inside(std::to_string(i)), out);
  else if (node.is_boolean())
    out.numbers[name] = node.get<bool>() ? 1.0 : 0.0;
  else if (node.is_number())
    out.numbers[name] = node.get<double>();
  else if (node.is_string())
    out.texts[name] = node.get<std::string>();
}

}  // namespace

FlatJson read_json(const std::filesystem::path& path) {
  const auto parsed = nlohmann::json::parse(read_whole_file(path), nullptr, false);
  if (parsed.is_discarded()) throw FileError("'" + path.string() + "' is not JSON, or was cut");
  FlatJson out;
  flatten(parsed, "", out);
  return out;
}

FlatJson flat_json(const std::string& text) {
  const auto parsed = nlohmann::json::parse(text, nullptr, false);
  FlatJson out;
  if (!parsed.is_discarded()) flatten(parsed, "", out);
  return out;
}

}  // namespace epafi
