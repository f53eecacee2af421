/// @file library.h  The scenes that come with the program.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace epafi {

/// share/epafi/scenes beside the installed program, else scenes/library of the source tree; empty where there is
/// neither.
std::filesystem::path library_folder();

/// `epafi list scenes`: path and title of every scene and study of the library, by path.
std::string list_scenes();

/// The file of that name, or that of the library which `epafi list scenes` shows under it, with or without .toml.
std::string scene_file(const std::string& name);

/// By its ending, or by the name of a table that scenes, studies or patch cases have; what comes through a pipe may be
/// one.
bool looks_like_scene(const std::filesystem::path& file);

/// As scene_file; throws FileError where there is no such file, SceneError where it is no scene. what: "scene file",
/// "study".
std::string existing_scene_file(const std::string& name, const std::string& what = "scene file");

/// The library's scenes that have a [benchmark].
std::vector<std::string> library_benchmarks();

}  // namespace epafi
