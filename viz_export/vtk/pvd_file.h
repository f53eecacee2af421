/// @file pvd_file.h  The .pvd list of a run's frames.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace epafi {

/// The list of frames that ParaView opens: which file shows at which time. Begun through a side file, then appended to
/// in place: what is added goes over the closing tags, with new ones behind it, in one write. A crash within that write
/// may leave the last line cut, which keep_until passes over.
class PvdFile {
 public:
  explicit PvdFile(std::filesystem::path path) : path_(std::move(path)) {}
  /// Reads the list written by an earlier run and keeps the frames up to `time` [s].
  void keep_until(double time);
  /// `file` relative to the folder of the .pvd; part numbers the files of one time.
  void add(double time, int part, const std::string& file);
  /// Puts on disk what was added since the last call.
  void write();
  /// Sets the group of later entries; empty: none.
  void group(const std::string& name) { group_ = name; }

  struct Entry {
    double time;
    int part;
    std::string file, group{};
  };
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::filesystem::path path_;
  std::vector<Entry> entries_;
  std::size_t listed_ = 0;  ///< entries in the file
  std::streamoff end_ = 0;  ///< of their last line in the file; 0: this object has not begun it
  std::string group_;
};

}  // namespace epafi
