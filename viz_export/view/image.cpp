#include "viz_export/view/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "engine/units/error.h"
#include "viz_export/hdf5/deflate.h"
#include "viz_export/view/glyphs.h"
#include "viz_export/view/more_glyphs.h"

namespace epafi {
namespace {

/// Advance and polygons of a character; null where the font has none.
const char* outline_of(char32_t c) {
  if (c >= 32 && c <= 126) return glyph_outlines[c - 32];
  constexpr std::size_t digits = 4;
  if (c > 0xFFFF) return nullptr;
  const std::string code = fmt::format("{:04X}", static_cast<std::uint32_t>(c));
  const auto before = [](const char* glyph, const std::string& wanted) {
    return wanted.compare(0, digits, glyph, digits) > 0;
  };
  const auto found = std::lower_bound(std::begin(more_glyphs), std::end(more_glyphs), code, before);
  return found != std::end(more_glyphs) && code.compare(0, digits, *found, digits) == 0 ? *found + digits : nullptr;
}

constexpr char32_t no_character = 0xFFFD;  // in place of what is no UTF-8

/// Removes and returns the first character of a text; control characters become blanks.
char32_t next_character(std::string_view& text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 0;
  char32_t c = length == 1 ? first : first & (0x7Fu >> length);
  bool whole = length > 0 && length <= text.size();
  for (std::size_t k = 1; whole && k < length; ++k) {
    whole = (byte(k) & 0xC0) == 0x80;
    c = c << 6 | (byte(k) & 0x3Fu);
  }
  text.remove_prefix(whole ? length : 1);
  return !whole ? no_character : c < 32 || c == 127 ? U' ' : c;
}

std::u32string characters_of(std::string_view text) {
  std::u32string out;
  while (!text.empty()) out += next_character(text);
  return out;
}

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

/// Adds the positions on a scan line where the winding number changes.
void cross(const std::vector<Edge>& edges, double y, std::vector<std::pair<double, int>>& out) {
  out.clear();
  for (const Edge& e : edges) {
    const bool down = e.y0 <= y && e.y1 > y, up = e.y1 <= y && e.y0 > y;
    if (down || up) out.emplace_back(e.x0 + (y - e.y0) / (e.y1 - e.y0) * (e.x1 - e.x0), down ? 1 : -1);
  }
  std::sort(out.begin(), out.end());
}

/// Adds `weight` to the coverage of pixels between two positions on a line.
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

namespace {

/// Box with the code of a character without an outline, in two rows.
struct CodeBox {
  std::string upper, lower;
  double digit_size, width;

  CodeBox(char32_t c, double size) : digit_size(0.5 * size) {
    const std::string code = fmt::format("{:04X}", static_cast<std::uint32_t>(c));
    upper = code.substr(0, code.size() / 2);
    lower = code.substr(code.size() / 2);
    width = std::max(text_width(upper, digit_size), text_width(lower, digit_size)) + 0.3 * size;
  }
  void draw(Image& image, double x, double y, const Rgb& colour) const {
    const double size = 2 * digit_size;
    const int left = static_cast<int>(x + 0.06 * size), right = static_cast<int>(x + width - 0.06 * size);
    const int top = static_cast<int>(y - 0.86 * size), bottom = static_cast<int>(y + 0.14 * size);
    for (const int row : {top, bottom}) fill_box(image, left, row, right - left + 1, 1, colour);
    for (const int column : {left, right}) fill_box(image, column, top, 1, bottom - top, colour);
    draw_text(image, x + 0.15 * size, y - 0.45 * size, upper, digit_size, colour);
    draw_text(image, x + 0.15 * size, y + 0.02 * size, lower, digit_size, colour);
  }
};

}  // namespace

double text_width(const std::string& text, double size) {
  double width = 0;
  for (const char32_t c : characters_of(text)) {
    const char* outline = outline_of(c);
    width += outline != nullptr ? size * unit(outline[0]) : CodeBox(c, size).width;
  }
  return width;
}

void draw_text(Image& image, double x, double y, const std::string& text, double size, const Rgb& colour) {
  for (const char32_t c : characters_of(text)) {
    if (const char* outline = outline_of(c); outline != nullptr) {
      draw_glyph(image, edges_of(outline, x, y, size), colour);
      x += size * unit(outline[0]);
    } else {
      const CodeBox box(c, size);
      box.draw(image, x, y, colour);
      x += box.width;
    }
  }
}

std::string without_outline(const std::string& text) {
  std::string out;
  std::u32string told;
  for (const char32_t c : characters_of(text)) {
    if (outline_of(c) != nullptr || told.find(c) != told.npos) continue;
    told += c;
    out += fmt::format("{}U+{:04X}", out.empty() ? "" : ", ", static_cast<std::uint32_t>(c));
  }
  return out;
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
