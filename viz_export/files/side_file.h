/// @file side_file.h  Atomic file replacement: writes beside the target and renames over it.
#pragma once
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace epafi {

class SideFile {
 public:
  /// `target` is where the file shall stand; write to path() and commit. A device (/dev/null) is written to as it is.
  /// ending: of the side file's name; one of its own for a file that several processes may write at the same time.
  explicit SideFile(std::filesystem::path target, const std::string& ending = ".part");
  ~SideFile();  ///< without a commit the side file is removed and the target is as it was
  SideFile(const SideFile&) = delete;
  SideFile& operator=(const SideFile&) = delete;

  const std::filesystem::path& path() const { return side_; }
  /// Renames over the target; `durable` also waits until file and folder are on disk (power loss, not only a crash).
  void commit(bool durable);

 private:
  std::filesystem::path target_, side_;
  bool aside_;  ///< side_ is a file of its own
  bool committed_ = false;
};

/// Writes the parts one behind the other to `target`, through a side file of its own: of several writers the last one
/// counts.
void write_whole_file(const std::filesystem::path& target, std::initializer_list<std::string_view> parts,
                      bool durable = false);

/// The whole content of a file; FileError where it cannot be read.
std::string read_whole_file(const std::filesystem::path& path);

/// Waits until the file's content is on disk.
void sync_to_disk(const std::filesystem::path& path);

}  // namespace epafi
