#include "viz_export/hdf5/hdf5_heaps.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/units/error.h"

namespace epafi {

namespace {

constexpr std::string_view signature("\x89HDF\r\n\x1a\n", 8), heap("HEAP\0", 5);  // with version 0
constexpr std::size_t size_of_offsets = 13, size_of_lengths = 14;                 // places in the superblock

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
  const std::size_t offset = static_cast<unsigned char>(head[size_of_offsets]),
                    length = static_cast<unsigned char>(head[size_of_lengths]);
  if (std::string_view(head.data(), signature.size()) != signature || head[signature.size()] > 1) return;
  if (offset < 2 || offset > 8 || length < 2 || length > 8) return;  // the library says so itself
  in.seekg(0);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  const std::string_view bytes(whole);
  const auto field = [&](std::size_t at, std::size_t size) { return little_endian(bytes.substr(at, size)); };
  std::vector<std::pair<std::uint64_t, std::uint64_t>> names;  // begin and end of those that are in the file
  std::vector<std::size_t> broken;
  for (std::size_t at = bytes.find(heap); at != bytes.npos; at = bytes.find(heap, at + 1)) {
    if (bytes.size() - at < 8 + 2 * length + offset) break;
    const std::uint64_t size = field(at + 8, length), place = field(at + 8 + 2 * length, offset);
    if (place <= bytes.size() && size <= bytes.size() - place)
      names.emplace_back(place, place + size);
    else
      broken.push_back(at);
  }
  for (const std::size_t at : broken)  // a member may be called HEAP
    if (std::none_of(names.begin(), names.end(), [&](const auto& n) { return at >= n.first && at < n.second; }))
      throw FileError(path.string() + ": is damaged: the names of a group at byte " + std::to_string(at) +
                      " are said to lie outside the file; get or write it again");
}

}  // namespace epafi
