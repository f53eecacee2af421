/// @file image.h  A picture in memory, text on it, and PNG.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "viz_export/view/colours.h"

namespace epafi {

/// Rows from above, three bytes per pixel.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  Image(int w, int h) : width(w), height(h), rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  std::uint8_t* at(int x, int y) {
    return &rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
  }
  /// Mixes in a colour; outside the picture nothing happens.
  void blend(int x, int y, const Rgb& colour, double share);
};

/// Width of a line of text [pixels]; size: height of its em.
[[nodiscard]] double text_width(const std::string& text, double size);
/// Baseline begins at (x, y); text: UTF-8. Latin, Greek and Cyrillic letters and signs of formulas have outlines
/// (more_glyphs.h); a character without one is drawn as its code in a box.
void draw_text(Image& image, double x, double y, const std::string& text, double size, const Rgb& colour);
/// The characters of a text that have no outline, each once: "U+6D4B, U+8BD5"; empty: all have one.
[[nodiscard]] std::string without_outline(const std::string& text);
void fill_box(Image& image, int x, int y, int width, int height, const Rgb& colour);

/// The bytes of a PNG file.
[[nodiscard]] std::string png_of(const Image& image);

}  // namespace epafi
