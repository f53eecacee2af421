/// @file page_target.h  What an output option may write over.
#pragma once
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string>

#include "engine/units/error.h"

namespace epafi {

/// True where a file begins as an HTML page, after a byte order mark and blanks.
inline bool begins_as_page(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text(512, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  const auto is_blank = [](unsigned char c) { return std::isspace(c) != 0; };
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), is_blank));
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text.starts_with("<!doctype html") || text.starts_with("<html");
}

/// True for a name with the extension of a page, by which programs choose how to open it.
inline bool is_page_name(const std::filesystem::path& target) {
  std::string ending = target.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".html" || ending == ".htm";
}

/// A page replaces nothing but a page: SceneError where the target is a folder, a file that holds anything else, or has
/// another ending. Devices and empty files hold nothing that could be lost.
inline void require_page_target(const std::filesystem::path& target) {
  std::error_code none;
  const std::string name = "--out " + target.string();
  if (std::filesystem::is_directory(target, none))
    throw SceneError(name + ": it is a folder; expected the name of a page, as page.html");
  const bool is_file = std::filesystem::is_regular_file(target, none);
  if (is_file && std::filesystem::file_size(target, none) > 0 && !begins_as_page(target))
    throw SceneError(name + ": this file is no HTML page and is left as it is; choose another name for the page");
  const bool is_device = std::filesystem::exists(target, none) && !is_file;
  if (!is_device && !is_page_name(target))
    throw SceneError(name + ": expected an ending .html: what is written is a page for the browser" +
                     (target.extension() == ".pdf" ? ", which prints it as PDF" : ""));
}

/// SceneError where the target is the input itself, by whatever name.
inline void require_not_the_input(const std::filesystem::path& target, const std::filesystem::path& input) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(target, none) || !std::filesystem::equivalent(target, input, none)) return;
  throw SceneError("--out " + target.string() + ": this is the input itself; choose another name");
}

}  // namespace epafi
