#include "viz_export/deflate.h"

#include <zlib.h>

namespace epafi {

std::string deflated(std::span<const char> bytes, int level) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  const auto* from = reinterpret_cast<const Bytef*>(bytes.data());
  const int status =
      compress2(reinterpret_cast<Bytef*>(out.data()), &size, from, static_cast<uLong>(bytes.size()), level);
  out.resize(status == Z_OK ? size : 0);
  return out;
}

std::uint32_t crc32_of(std::span<const char> bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

}  // namespace epafi
