/// @file folder_lock.h  An output folder belongs to one run at a time.
#pragma once
#include <filesystem>

namespace epafi {

/// Holds the folder until it goes, or the process ends in whatever way: the system's lock on the folder itself, no
/// file.
class FolderLock {
 public:
  /// Throws FileError where another run holds it. Folders that are not there, and file systems that know no locks, are
  /// not held.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int handle_ = -1;
};

}  // namespace epafi
