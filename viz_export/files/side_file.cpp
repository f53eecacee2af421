#include "viz_export/files/side_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include "engine/units/error.h"

namespace epafi {

namespace {
[[noreturn]] void fail(const std::filesystem::path& path, const char* operation) {
  const int cause = errno;
  throw FileError(path.string() + ": cannot " + operation + ": " +
                  (cause != 0 ? std::strerror(cause) : "unknown cause"));
}
}  // namespace

void sync_to_disk(const std::filesystem::path& path) {
  errno = 0;
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail(path, "open to sync");
  const bool done = ::fsync(file) == 0 || errno == EINVAL;  // some file systems cannot sync a folder
  ::close(file);
  if (!done) fail(path, "sync to disk");
}

SideFile::SideFile(std::filesystem::path target, const std::string& ending)
    : target_(std::move(target)),
      side_(target_.string() + ending),
      aside_(!std::filesystem::exists(target_) || std::filesystem::is_regular_file(target_)) {
  if (!aside_) side_ = target_;
}

SideFile::~SideFile() {
  std::error_code ignored;
  if (aside_ && !committed_) std::filesystem::remove(side_, ignored);
}

void SideFile::commit(bool durable) {
  if (!aside_) return;
  if (durable) sync_to_disk(side_);
  errno = 0;
  if (std::rename(side_.c_str(), target_.c_str()) != 0) fail(target_, "rename the finished file to");
  committed_ = true;
  if (durable) sync_to_disk(target_.has_parent_path() ? target_.parent_path() : std::filesystem::path("."));
}

void write_whole_file(const std::filesystem::path& target, std::initializer_list<std::string_view> parts,
                      bool durable) {
  static std::atomic<unsigned> written{0};
  SideFile side(target, "." + std::to_string(::getpid()) + "-" + std::to_string(written++) + ".part");
  errno = 0;
  std::ofstream out(side.path(), std::ios::binary);
  if (!out) fail(target, "create");
  for (std::string_view part : parts) out.write(part.data(), static_cast<std::streamsize>(part.size()));
  out.close();
  if (!out) fail(target, "write");
  side.commit(durable);
}

std::string read_whole_file(const std::filesystem::path& path) {
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(path, "open");
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (in.bad()) fail(path, "read");
  return text;
}

}  // namespace epafi
