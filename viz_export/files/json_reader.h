/// @file json_reader.h  Reads a JSON file into flat names: {"overlap": {"max": 1}} gives overlap.max = 1, an element of
/// an array counts from 0. The only door to nlohmann/json.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace epafi {

struct FlatJson {
  std::map<std::string, double> numbers;  ///< true and false count as 1 and 0
  std::map<std::string, std::string> texts;

  std::optional<double> number(const std::string& name) const {
    const auto at = numbers.find(name);
    return at == numbers.end() ? std::nullopt : std::optional(at->second);
  }
  std::string text(const std::string& name) const {
    const auto at = texts.find(name);
    return at == texts.end() ? std::string{} : at->second;
  }
};

/// Throws FileError where the file cannot be read or is no JSON. null has no entry.
FlatJson read_json(const std::filesystem::path& path);
/// The same of a text; empty where it is no JSON.
FlatJson flat_json(const std::string& text);

}  // namespace epafi
