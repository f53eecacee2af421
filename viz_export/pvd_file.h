/// @file pvd_file.h  The .pvd list of a run's frames.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace epafi {

/// The list of frames that ParaView opens: which file shows at which time. Rewritten as a whole through a side file.
class PvdFile {
 public:
  explicit PvdFile(std::filesystem::path path) : path_(std::move(path)) {}
  /// Reads the list written by an earlier run and keeps the frames up to `time` [s].
  void keep_until(double time);
  /// `file` relative to the folder of the .pvd; part numbers the files of one time.
  void add(double time, int part, const std::string& file);
  void write() const;

  struct Entry {
    double time;
    int part;
    std::string file;
  };
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::filesystem::path path_;
  std::vector<Entry> entries_;
};

}  // namespace epafi
