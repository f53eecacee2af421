#include "viz_export/view/image.h"

#include <cmath>

#include "engine/units/error.h"
#include "viz_export/hdf5/deflate.h"
#include "viz_export/view/glyphs.h"

namespace epafi {
namespace {

const char* outline_of(char c) { return glyph_outlines[c < 32 || c > 126 ? '?' - 32 : c - 32]; }

double unit(char digit) { return (digit - '0') / 64.0; }

struct Edge {
  double x0, y0, x1, y1;
};

/// Edges of a character at (x, y), in pixels, y downwards.
std::vector<Edge> edges_of(const char* outline, double x, double y, double size) {
  std::vector<Edge> out;
  const char* at = outline + 1;
  while (*at == ' ') {
    ++at;
    std::vector<std::pair<double, double>> loop;
    for (; *at != '\0' && *at != ' '; at += 2)
      loop.emplace_back(x + size * unit(at[0]), y - size * (unit(at[1]) - 0.25));
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const auto& [x0, y0] = loop[k];
      const auto& [x1, y1] = loop[(k + 1) % loop.size()];
      out.push_back({x0, y0, x1, y1});
    }
  }
  return out;
}

/// Adds the winding of the edges along one scan line: places where it changes.
void cross(const std::vector<Edge>& edges, double y, std::vector<std::pair<double, int>>& out) {
  out.clear();
  for (const Edge& e : edges) {
    const bool down = e.y0 <= y && e.y1 > y, up = e.y1 <= y && e.y0 > y;
    if (down || up) out.emplace_back(e.x0 + (y - e.y0) / (e.y1 - e.y0) * (e.x1 - e.x0), down ? 1 : -1);
  }
  std::sort(out.begin(), out.end());
}

/// Shares of the pixels between two places of a line.
void cover(std::vector<double>& shares, double from, double to, double weight) {
  for (auto k = static_cast<std::ptrdiff_t>(std::floor(from)); static_cast<double>(k) < to; ++k) {
    if (k < 0 || k >= static_cast<std::ptrdiff_t>(shares.size())) continue;
    const double x = static_cast<double>(k);
    shares[static_cast<std::size_t>(k)] += weight * (std::min(to, x + 1) - std::max(from, x));
  }
}

void draw_glyph(Image& image, const std::vector<Edge>& edges, const Rgb& colour) {
  if (edges.empty()) return;
  double top = 1e30, bottom = -1e30;
  for (const Edge& e : edges) {
    top = std::min(top, e.y0);
    bottom = std::max(bottom, e.y0);
  }
  constexpr int parts = 4;  // scan lines per row of pixels
  std::vector<std::pair<double, int>> changes;
  for (int y = static_cast<int>(std::floor(top)); y <= static_cast<int>(bottom); ++y) {
    std::vector<double> shares(static_cast<std::size_t>(image.width), 0.0);
    for (int part = 0; part < parts; ++part) {
      cross(edges, y + (part + 0.5) / parts, changes);
      int winding = 0;
      for (std::size_t k = 0; k + 1 < changes.size(); ++k) {
        winding += changes[k].second;
        if (winding != 0) cover(shares, changes[k].first, changes[k + 1].first, 1.0 / parts);
      }
    }
    for (int x = 0; x < image.width; ++x)
      if (shares[static_cast<std::size_t>(x)] > 0) image.blend(x, y, colour, shares[static_cast<std::size_t>(x)]);
  }
}

void put_big_endian(std::string& out, std::uint32_t v) {
  for (int byte = 3; byte >= 0; --byte) out += static_cast<char>(v >> (8 * byte) & 255u);
}

void put_piece(std::string& out, const std::string& name, const std::string& data) {
  put_big_endian(out, static_cast<std::uint32_t>(data.size()));
  const std::string piece = name + data;
  out += piece;
  put_big_endian(out, crc32_of(piece));
}

}  // namespace

void Image::blend(int x, int y, const Rgb& colour, double share) {
  if (x < 0 || y < 0 || x >= width || y >= height) return;
  std::uint8_t* pixel = at(x, y);
  for (std::size_t k = 0; k < 3; ++k)
    pixel[k] = static_cast<std::uint8_t>(std::lround(pixel[k] + std::min(1.0, share) * (255.0 * colour[k] - pixel[k])));
}

double text_width(const std::string& text, double size) {
  double width = 0;
  for (const char c : text) width += size * unit(outline_of(c)[0]);
  return width;
}

void draw_text(Image& image, double x, double y, const std::string& text, double size, const Rgb& colour) {
  for (const char c : text) {
    draw_glyph(image, edges_of(outline_of(c), x, y, size), colour);
    x += size * unit(outline_of(c)[0]);
  }
}

void fill_box(Image& image, int x, int y, int width, int height, const Rgb& colour) {
  for (int row = y; row < y + height; ++row)
    for (int column = x; column < x + width; ++column) image.blend(column, row, colour, 1.0);
}

std::string png_of(const Image& image) {
  std::string raw;
  const std::size_t row = 3 * static_cast<std::size_t>(image.width);
  for (int y = 0; y < image.height; ++y) {  // each row as differences from the one above
    raw += '\2';
    for (std::size_t k = 0; k < row; ++k) {
      const std::uint8_t now = image.rgb[static_cast<std::size_t>(y) * row + k];
      const std::uint8_t above = y > 0 ? image.rgb[static_cast<std::size_t>(y - 1) * row + k] : std::uint8_t{0};
      raw += static_cast<char>(now - above);
    }
  }
  const std::string stream = deflated(raw, 4);
  if (stream.empty()) throw FileError("zlib ran out of memory");
  std::string out = "\x89PNG\r\n\x1a\n", head;
  put_big_endian(head, static_cast<std::uint32_t>(image.width));
  put_big_endian(head, static_cast<std::uint32_t>(image.height));
  head += std::string("\10\2\0\0\0", 5);
  put_piece(out, "IHDR", head);
  put_piece(out, "IDAT", stream);
  put_piece(out, "IEND", "");
  return out;
}

}  // namespace epafi
