/// @file parts_folder.h  A folder for files on the way to a page: beside the page, gone with this. The run's own may be
/// one that is only read.
#pragma once
#include <filesystem>

namespace epafi {

class PartsFolder {
 public:
  /// Throws FileError where it cannot be made.
  explicit PartsFolder(const std::filesystem::path& page);
  ~PartsFolder();
  PartsFolder(const PartsFolder&) = delete;
  PartsFolder& operator=(const PartsFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace epafi
