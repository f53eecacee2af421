#include "viz_export/hdf5/damaged_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>

#include "viz_export/files/run_folder.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view hdf5_signature("\x89HDF\r\n\x1a\n", 8);

/// The length that an HDF5 file states: the end-of-file address of its superblock (HDF5 File Format Specification,
/// II.A), with addresses of 8 bytes as this program writes them.
std::optional<std::uint64_t> length_by_superblock(const fs::path& file) {
  std::array<char, 56> head{};
  std::ifstream in(file, std::ios::binary);
  if (!in.read(head.data(), head.size())) return std::nullopt;
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(head[at]); };
  const unsigned version = byte(8);
  if (version > 3 || byte(version < 2 ? 13 : 9) != 8) return std::nullopt;
  constexpr std::array<std::size_t, 4> place{40, 44, 28, 28};
  std::uint64_t length = 0;
  for (std::size_t k = 8; k-- > 0;) length = length << 8 | byte(place[version] + k);
  return length;
}

}  // namespace

std::string damage_text(const fs::path& file, const std::string& cause) {
  std::error_code none;
  const std::uintmax_t size = fs::file_size(file, none);
  if (none) return cause;
  if (size == 0) return file.string() + ": is empty";
  std::array<char, 8> start{};
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) return file.string() + ": cannot be read: " + std::strerror(errno != 0 ? errno : EIO);
  in.read(start.data(), start.size());
  const auto got = static_cast<std::size_t>(in.gcount());
  if (std::string_view(start.data(), got) != hdf5_signature.substr(0, got))
    return file.string() + ": is no HDF5 file, or its beginning was overwritten";
  const auto length = length_by_superblock(file);
  if (got < hdf5_signature.size() || !length)
    return fmt::format("{}: is cut short: {} bytes of it are there", file.string(), size);
  if (*length > size)
    return fmt::format("{}: is cut short: {} of its {} bytes are there", file.string(), size, *length);
  return cause;
}

DamagedRun::DamagedRun(const fs::path& file, std::string found)
    : FileError(found + what_is_left(file.parent_path())), damage(std::move(found)) {}

}  // namespace epafi
