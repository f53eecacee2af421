/// @file run_file.h  run.h5: what a run was and how its bodies moved. Plain HDF5, meant to be read with h5py:
///   attributes kind, format, version, scene_hash, title; texts scene, overrides, about (names of
///                     bodies and materials, springs, view: see view/settings.h)
///   bodies/{shape, surface, material, mass, radius}   one row per body id; surface: number in shapes/, -1 for
///                     spheres; rows of bodies that have not come yet are 0
///   shapes/NNNNNN/{points, connectivity, offsets}     polygons about the centre of mass, in the axes in which the
///                     scene wrote the shape; attributes name (as the scene wrote it) and size (factor of its lengths)
///   snapshots/NNNNNN  attributes time, step, state_hash; id, position (centre of mass, inside a periodic cell),
///   velocity,
///                     kinetic_energy and, where the scene rotates, orientation (w x y z, of the axes in which the
///                     scene wrote the shape) and angular_velocity; rows in the order of body ids
///   measures/NAME     attributes name, kind, components; time, value (one column per component)
/// The file is open only while something is written: a crash between snapshots leaves it whole, and others may read it
/// meanwhile. A crash within a write can spoil it: readers then get a FileError; the checkpoint is another file.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "viz_export/files/body_origin.h"
#include "viz_export/files/body_record.h"

namespace epafi {

struct RunFileHeader {
  std::string version, scene_hash, title, scene_text;
  std::vector<std::string> overrides;
  std::string about{};    ///< names, springs, view (view/settings.h)
  ShapeOrigins shapes{};  ///< names and axes of those in use
};

/// State of one instant beside its bodies.
struct SnapshotStamp {
  std::uint64_t step = 0;
  double time = 0.0;  ///< [s]
  std::string state_hash;
  bool rotates = false;          ///< angular velocity is stored
  bool has_orientation = false;  ///< orientation is stored
  std::string stage{};           ///< name of the stage; may be empty
};

class Hdf5File;
class OutputThread;

class RunFile {
 public:
  /// A new file.
  RunFile(std::filesystem::path path, const RunFileHeader& header);
  /// Continues the file of an interrupted run: snapshots after `step` and measures after `time` [s] are dropped.
  RunFile(std::filesystem::path path, const RunFileHeader& header, std::uint64_t step, double time);

  /// Rows of a measure that wait to be written.
  struct Rows {
    std::size_t measure;
    std::vector<double> times, values;
  };
  /// Data written with one snapshot, including measures up to it.
  struct Snapshot {
    SnapshotStamp stamp;
    std::vector<Rows> measures;
  };
  /// Begins a snapshot, which must be written; none where the file has one of this step or a later one.
  std::optional<Snapshot> begin_snapshot(SnapshotStamp stamp);
  /// Writes a snapshot; may be called by another thread.
  void write(const Snapshot& snapshot, const BodyList& bodies);
  /// Both.
  void add_snapshot(const SnapshotStamp& stamp, const BodyList& bodies);
  /// Rows of measures go to the file by this thread from now on.
  void write_beside(OutputThread& thread) { beside_ = &thread; }
  /// Number of a measure for add_measure; one that the file already holds is continued.
  /// kind: as in the scene.
  std::size_t define_measure(const std::string& name, const std::vector<std::string>& components,
                             const std::string& kind = {});
  void add_measure(std::size_t measure, double time, const std::vector<double>& values);
  /// References of shapes mean these from here on.
  void renew_shapes(const ShapeOrigins& shapes) {
    surfaces_.clear();
    origins_ = shapes;
  }
  /// Writes buffered measures and waits until the file is on disk: call before a checkpoint.
  void flush();

 private:
  struct Measure {
    std::string group;
    std::size_t components;
    std::vector<double> times, values;
  };
  void drop_after(std::uint64_t step, double time);
  std::vector<Rows> take_measures();
  void append_measures(const std::vector<Rows>& rows);
  void append_measures(Hdf5File& file, const std::vector<Rows>& rows);
  void append_bodies(Hdf5File& file, const BodyList& bodies);
  void describe_late(Hdf5File& file, const BodyList& bodies);
  void write_orientations(Hdf5File& file, const std::string& group, const BodyList& bodies);
  void add_surface(Hdf5File& file, const BodyRecord& body);
  std::filesystem::path path_;
  ShapeOrigins origins_;
  OutputThread* beside_ = nullptr;
  std::vector<Measure> measures_;
  std::size_t buffered_ = 0;                        ///< values of measures waiting
  std::map<std::uint32_t, std::int32_t> surfaces_;  ///< number in shapes/ by packed reference
  std::int32_t shape_groups_ = 0;                   ///< in shapes/, also of references that mean others now
  std::size_t snapshots_ = 0;
  std::vector<bool> described_;  ///< by body id with a row in bodies/: the row is that of a body that was there
  std::int64_t last_step_ = -1;  ///< of the last snapshot that was begun
};

}  // namespace epafi
