#include "viz_export/hdf5_heaps.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>

#include "engine/error.h"

namespace epafi {

namespace {

constexpr std::string_view signature("\x89HDF\r\n\x1a\n", 8), heap("HEAP\0\0\0\0", 8);  // with version 0
constexpr std::size_t size_of_offsets = 13, size_of_lengths = 14;                       // places in the superblock

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t k = bytes.size(); k > 0; --k) value = value << 8 | static_cast<unsigned char>(bytes[k - 1]);
  return value;
}

}  // namespace

void refuse_broken_heaps(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, 16> head{};
  if (!in.read(head.data(), head.size())) return;
  const auto offset = static_cast<std::size_t>(head[size_of_offsets]),
             length = static_cast<std::size_t>(head[size_of_lengths]);
  if (std::string_view(head.data(), signature.size()) != signature || head[signature.size()] > 1) return;
  if (offset < 2 || offset > 8 || length < 2 || length > 8) return;  // the library says so itself
  in.seekg(0);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  const std::string_view bytes(whole);
  for (std::size_t at = bytes.find(heap); at != bytes.npos; at = bytes.find(heap, at + 1)) {
    if (bytes.size() - at < heap.size() + 2 * length + offset) break;
    const std::uint64_t size = little_endian(bytes.substr(at + heap.size(), length)),
                        place = little_endian(bytes.substr(at + heap.size() + 2 * length, offset));
    if (place <= bytes.size() && size <= bytes.size() - place) continue;
    throw FileError(path.string() + ": is damaged: the names of a group at byte " + std::to_string(at) +
                    " are said to lie outside the file; get or write it again");
  }
}

}  // namespace epafi
