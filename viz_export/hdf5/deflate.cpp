#include "viz_export/hdf5/deflate.h"

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

std::string deflated_runs(std::span<const char> bytes) {
  z_stream stream{};
  constexpr int window = 15, memory = 9;
  if (deflateInit2(&stream, 6, Z_DEFLATED, window, memory, Z_RLE) != Z_OK) return {};
  std::string out(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib reads it only
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = deflate(&stream, Z_FINISH);
  out.resize(status == Z_STREAM_END ? stream.total_out : 0);
  deflateEnd(&stream);
  return out;
}

std::uint32_t crc32_of(std::span<const char> bytes) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

}  // namespace epafi
