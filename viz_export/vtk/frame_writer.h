/// @file frame_writer.h  The frames of a run for ParaView: spheres as points, other bodies as surfaces, contacts as
/// lines with force, and walls (fixed and driven bodies) again only when they moved. frames/*.vtp, listed with times in
/// frames.pvd.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/state/state_visitor.h"
#include "viz_export/files/body_record.h"
#include "viz_export/vtk/contact_list.h"
#include "viz_export/vtk/frame_columns.h"
#include "viz_export/vtk/pvd_file.h"

namespace epafi {

/// Centres with radius, id, material, speed, kinetic_energy, velocity, angular_velocity.
PolyData draw_spheres(const BodyList& bodies, double time, FrameRows rows);
/// Polygons in world axes, with id, material, speed, kinetic_energy and velocity on every polygon.
PolyData draw_surfaces(const BodyList& bodies, double time);
/// Lines with force, force_magnitude, normal_force, overlap, id_a, id_b and, of non-smooth contact, residual.
PolyData draw_contacts(const ContactRows& contacts, double time);

class FrameWriter {
 public:
  /// Frames go to folder/frames, the list to folder/frames.pvd.
  explicit FrameWriter(std::filesystem::path folder);
  /// Continues a run: frames later than `time` [s] leave the list and are overwritten.
  FrameWriter(std::filesystem::path folder, double time);

  /// A frame of the same time as the last one is not written again. Kinds without members get no file.
  /// `meanwhile` writes another file of the same time beside them; its error goes first.
  void write(double time, const BodyList& bodies, const ContactList& contacts,
             const std::function<void()>& meanwhile = {});
  /// Writes a frame of bodies from run.h5, which holds no contacts: contact files of the run stay in the list.
  void write_bodies(double time, const BodyList& bodies);
  /// The next frames are listed under this name; empty: none.
  void name_stage(const std::string& name) { list_.group(name); }
  std::size_t frames() const { return next_; }
  /// Frame in which the walls were last written: without it a resumed run writes them once more.
  void visit(StateVisitor& visitor);

 private:
  struct Entry;
  std::string file_of(const char* kind) const;
  Entry surfaces_entry(int part, const char* kind, const BodyList& bodies, double time) const;
  Entry walls_entry(const BodyList& walls, double time) const;
  std::vector<Entry> draw(double time, const BodyList& bodies, const ContactList* contacts) const;
  void list(double time, std::vector<Entry>& files);
  std::filesystem::path folder_;
  PvdFile list_;
  std::size_t next_ = 0;            ///< number of the next frame
  std::vector<double> wall_poses_;  ///< of the walls as last written
  std::string wall_file_;           ///< "" before the first
};

}  // namespace epafi
