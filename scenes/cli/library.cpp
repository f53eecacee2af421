#include "scenes/cli/library.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <vector>

#include "engine/units/error.h"
#include "scenes/reader/document.h"

namespace epafi {

namespace fs = std::filesystem;

fs::path library_folder() {
  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none);
  // where /proc is not mounted the program does not know where it lies
  for (const fs::path& folder : {program.parent_path().parent_path() / "share/epafi/scenes", fs::path(EPAFI_LIBRARY),
                                 fs::path("/usr/share/epafi/scenes")})
    if (fs::is_directory(folder, none)) return folder;
  return {};
}

namespace {

/// Every scene and study of the library, by path.
std::vector<fs::path> library_files() {
  std::vector<fs::path> files;
  const fs::path folder = library_folder();
  if (folder.empty()) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::string scene_file(const std::string& name) {
  std::error_code none;
  const fs::path folder = library_folder();
  if (fs::exists(name, none) || folder.empty() || fs::path(name).is_absolute()) return name;
  for (const fs::path& file : {folder / name, folder / (name + ".toml")})
    if (fs::is_regular_file(file, none)) return file.string();
  return name;
}

bool looks_like_scene(const fs::path& file) {
  std::error_code none;
  if (fs::is_fifo(file, none)) return true;
  if (!fs::is_regular_file(file, none)) return false;
  if (file.extension() == ".toml") return true;
  constexpr std::size_t most_lines = 10'000;
  std::ifstream in(file);
  std::string line;
  for (std::size_t k = 0; k < most_lines && std::getline(in, line); ++k) {
    if (line.find('\0') != line.npos) return false;  // no text: the scene of a run stands in its run.h5 too
    line.erase(0, line.find_first_not_of(" \t["));
    for (const char* word : {"run", "world", "body", "bodies", "fill", "material", "contact", "shape", "measure",
                             "scene", "patch", "vary", "include", "params"}) {
      const std::size_t end =
          line.starts_with(word) ? line.find_first_not_of(" \t", std::string(word).size()) : line.npos;
      if (end != line.npos && std::string("].=").find(line[end]) != std::string::npos) return true;
    }
  }
  return false;
}

std::string existing_scene_file(const std::string& name, const std::string& what) {
  const std::string file = scene_file(name);
  std::error_code none;
  if (!fs::exists(file, none))
    throw FileError("the " + what + " '" + name + "' does not exist; `epafi list scenes` names those of the library");
  if (fs::is_directory(file, none))
    throw SceneError(
        "'" + name + "' is a folder; a " + what + " is a TOML file" +
        (fs::exists(fs::path(file) / "run.h5", none) ? "; `epafi resume`, `view`, `report` take a run's folder" : ""));
  if (!looks_like_scene(file)) throw SceneError("'" + name + "' is no " + what + ": that is a TOML file");
  return file;
}

std::string list_scenes() {
  const fs::path folder = library_folder();
  if (folder.empty()) return "scenes: the library is not installed\n";
  std::string out = "scenes: " + folder.string() + "\n";
  for (const auto& file : library_files()) {
    const Document document = load_document(file.string(), {});
    const Node* title = document.root.find("title");
    out += fmt::format("  {:<36}{}\n", file.lexically_relative(folder).string(), title ? title->text : "");
  }
  return out;
}

std::vector<std::string> library_benchmarks() {
  std::vector<std::string> scenes;
  for (const auto& file : library_files())
    if (load_document(file.string(), {}).root.find("benchmark")) scenes.push_back(file.string());
  return scenes;
}

}  // namespace epafi
