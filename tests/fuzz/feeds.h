/// @file feeds.h  Any bytes, given to a reader: they end in a value or in a message that names place and cause, never
/// in anything else. The fuzz targets call these with bytes of their own making, the tests with the corpus of
/// tests/data/fuzz.
#pragma once
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "detection/shapes/hull_from_points.h"
#include "detection/shapes/mesh_file.h"
#include "detection/shapes/triangle_mesh.h"
#include "scenes/assemble.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "viz_export/hdf5/checkpoint.h"
#include "viz_export/hdf5/problem_file.h"
#include "viz_export/hdf5/run_file.h"
#include "viz_export/hdf5/stored_run.h"

namespace epafi::fuzz {

inline void must(bool holds, const char* what, const std::string& detail) {
  if (holds) return;
  std::fprintf(stderr, "%s: %s\n", what, detail.c_str());
  std::abort();
}

/// Runs `read`; its refusals must name the input and say something of it. True where nothing was refused.
template <class Read>
bool accepted(const std::string& file, const Read& read) {
  try {
    read();
    return true;
  } catch (const SceneError& e) {
    for (const Problem& p : e.problems()) must(!p.text.empty(), "a message without a cause", p.to_string());
    must(std::string_view(e.what()).find(file) != std::string_view::npos, "a message without its place", e.what());
  } catch (const FileError& e) {
    const std::string_view text(e.what());
    must(text.find(file) != text.npos && text.size() > file.size() + 5, "a message without its place", e.what());
  }
  return false;
}

/// Bytes as a file that goes when this goes: in memory where the machine has /dev/shm.
class InputFile {
 public:
  InputFile(std::string_view bytes, const char* ending)
      : path_(folder() / ("epafi-fuzz-" + std::to_string(getpid()) + ending)) {
    std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  ~InputFile() {
    std::error_code none;
    std::filesystem::remove(path_, none);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  static std::filesystem::path folder() {
    std::error_code none;
    return std::filesystem::is_directory("/dev/shm", none) ? std::filesystem::path("/dev/shm")
                                                           : std::filesystem::temp_directory_path();
  }
  std::filesystem::path path_;
};

/// A scene: read; a small one that is sound is also made ready and stepped twice.
inline bool feed_scene(std::string_view bytes) {
  const ReadResult read = read_scene_text(std::string(bytes), "fuzz.toml", {}, full_registry());
  bool refused = false;
  for (const Problem& p : read.problems) {
    must(!p.text.empty() && !p.place.file.empty(), "a message without place or cause", p.to_string());
    refused = refused || p.level == Problem::Level::error;
  }
  must(read.scene.has_value() != refused, "refused without a message, or taken with one", "");
  if (!read.scene) return false;
  const Scene& scene = *read.scene;
  const auto is_heavy = [](const ShapeSpec& s) { return s.type == "wheel_profile" || s.type == "rail_profile"; };
  double filled = 0;  // bodies of fills: their number is not always known
  for (const FillSpec& f : scene.fills) filled += f.count ? static_cast<double>(*f.count) : 1e9;
  if (static_cast<double>(scene.bodies.size()) + filled > 30 ||
      std::any_of(scene.shapes.begin(), scene.shapes.end(), is_heavy))
    return true;
  return accepted("fuzz.toml", [&] {
    const auto ready = assemble(scene);
    Simulation& sim = *ready->simulation;
    sim.start();
    for (int k = 0; k < 2; ++k)
      if (const auto failure = sim.advance()) return must(!failure->text.empty(), "a failure without a cause", "");
  });
}

/// A surface: the first byte chooses OBJ, STL or PLY. What is read is also made a wall, and a hull where it is small.
inline bool feed_mesh(std::string_view bytes) {
  if (bytes.empty()) return false;
  const int format = bytes[0] % 3;
  bytes.remove_prefix(1);
  return accepted("fuzz", [&] {
    const MeshFile mesh = format == 0   ? read_obj(bytes, "fuzz.obj")
                          : format == 1 ? read_stl(bytes, "fuzz.stl")
                                        : read_ply(bytes, "fuzz.ply");
    for (const Triangle& t : mesh.surface.triangles)
      for (const std::uint32_t v : t) must(v < mesh.surface.vertices.size(), "a triangle without its vertex", "");
    const TriangleMesh wall = TriangleMesh::from_surface(mesh.surface);
    std::vector<std::uint32_t> near;
    wall.query({wall.vertices[0] - Vec3(1, 1, 1), wall.vertices[0] + Vec3(1, 1, 1)}, near);
    if (mesh.surface.vertices.size() <= 40) (void)hull_from_points(mesh.surface.vertices, {"fuzz hull", 0, 0});
  });
}

/// A friction-contact problem: the first byte chooses FCLIB's HDF5 or Siconos' text.
inline bool feed_problem(std::string_view bytes) {
  if (bytes.empty()) return false;
  const InputFile file(bytes.substr(1), bytes[0] % 2 ? ".dat" : ".hdf5");
  return accepted(file.path().string(), [&] { (void)read_problem(file.path()); });
}

/// What the run files and checkpoints of the corpus say of themselves.
inline const RunFileHeader run_header{"0.1.0", "00ff", "fuzz", "[run]\nduration = 1\n", {}};

/// run.h5 or checkpoint.h5: everything in it is read; a run file is also continued, as by `resume`.
inline bool feed_run(std::string_view bytes) {
  const InputFile file(bytes, ".h5");
  const std::string name = file.path().string();
  const bool is_run = accepted(name, [&] {
    const StoredRun run(file.path());
    for (std::size_t k = 0; k < std::min<std::size_t>(run.snapshots(), 20); ++k) (void)run.snapshot(k);
    (void)run.measures();
    (void)run.title();
    (void)run.scene_text();
    (void)run.overrides();
  });
  if (!is_run) return accepted(name, [&] { (void)read_checkpoint_header(file.path()); });
  accepted(name, [&] {
    RunFile going_on(file.path(), run_header, 5, 0.5);
    going_on.add_measure(going_on.define_measure("height", {"x"}), 0.6, {1.0});
    going_on.flush();
  });
  return true;
}

}  // namespace epafi::fuzz
