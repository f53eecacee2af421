/// @file stored_run.h  Reads run.h5 back. Every function throws FileError on a file that is damaged, cut or not a run.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "viz_export/hdf5/run_file.h"

namespace epafi {

struct StoredSnapshot {
  SnapshotStamp stamp;
  std::vector<BodyRecord> bodies;  ///< their surfaces belong to the StoredRun
};

struct StoredMeasure {
  std::string name;
  std::string kind;  ///< as in the scene; "" in older files
  std::vector<std::string> components;
  std::vector<double> times, values;  ///< values row by row
};

/// Words of the scene for shape, material and group of a body.
struct StoredWords {
  std::string shape;     ///< name or table of a shape that is no sphere; "" where the file does not say
  double size = 1.0;     ///< factor of the shape's lengths
  std::string material;  ///< name; "" where the file does not say
  std::string group;     ///< name of the body's table; may be ""
};

class StoredRun {
 public:
  explicit StoredRun(const std::filesystem::path& path);
  ~StoredRun();
  std::size_t snapshots() const;
  StoredSnapshot snapshot(std::size_t k) const;
  double time(std::size_t k) const;             ///< of a snapshot [s]
  std::string state_hash(std::size_t k) const;  ///< of a snapshot
  std::vector<BodyRecord> bodies() const;       ///< all that were ever stored, by id, without motion
  std::vector<StoredMeasure> measures() const;
  StoredWords words(const BodyRecord& body) const;
  /// Points of shapes and orientations are of the axes that the scene wrote; in older files of principal axes.
  bool has_axes_of_the_scene() const;
  std::string version() const;  ///< of the program that began it
  std::string title() const;
  std::string about() const;  ///< names, springs, view (view/settings.h); "" in older files
  std::string scene_text() const;
  std::string overrides() const;  ///< one per line

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Why the run file cannot be read through (torn by a crash of the machine, cut, not there); "" where it can, or where
/// it is whole but of another kind or format, which its readers refuse.
[[nodiscard]] std::string damage_of(const std::filesystem::path& path);

}  // namespace epafi
