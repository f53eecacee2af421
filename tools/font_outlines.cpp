// Writes viz_export/view/glyphs.h: outlines of the printable ASCII characters of DejaVu Sans, flattened to polygons.
//   g++ -O1 tools/font_outlines.cpp $(pkg-config --cflags --libs freetype2) -o font_outlines
//   ./font_outlines /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf > viz_export/view/glyphs.h
#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <cstdio>
#include <string>
#include <vector>

struct Point {
  double x, y;
};
struct Pen {
  std::vector<std::vector<Point>> loops;
};

int move_to(const FT_Vector* p, void* pen) {
  static_cast<Pen*>(pen)->loops.push_back({{double(p->x), double(p->y)}});
  return 0;
}
int line_to(const FT_Vector* p, void* pen) {
  static_cast<Pen*>(pen)->loops.back().push_back({double(p->x), double(p->y)});
  return 0;
}
int conic_to(const FT_Vector* c, const FT_Vector* p, void* pen) {
  auto& loop = static_cast<Pen*>(pen)->loops.back();
  const Point a = loop.back();
  for (int k = 1; k <= 3; ++k) {
    const double t = k / 3.0, s = 1 - t;
    loop.push_back({s * s * a.x + 2 * s * t * c->x + t * t * p->x, s * s * a.y + 2 * s * t * c->y + t * t * p->y});
  }
  return 0;
}
int cubic_to(const FT_Vector*, const FT_Vector*, const FT_Vector* p, void* pen) { return line_to(p, pen); }

// Whole steps of 1/64 of the em, as one character each, beginning with '0'; y from -16.
char digit(double v) { return char('0' + int(v + 0.5)); }

int main(int, char** argv) {
  FT_Library library;
  FT_Face face;
  FT_Init_FreeType(&library);
  FT_New_Face(library, argv[1], 0, &face);
  FT_Set_Pixel_Sizes(face, 0, 64);
  const FT_Outline_Funcs functions{move_to, line_to, conic_to, cubic_to, 0, 0};
  std::printf(
      "/// @file glyphs.h  Outlines of the printable ASCII characters, made by tools/font_outlines.cpp from DejaVu "
      "Sans\n"
      "/// (Bitstream Vera and public domain; free to use, change and pass on). Of each character: its advance, then\n"
      "/// polygons divided by blanks; a point is two characters, x and y + 16 in 1/64 of the em, counted from '0'.\n"
      "#pragma once\n\nnamespace epafi {\n\ninline constexpr const char* glyph_outlines[95] = {\n");
  for (int c = 32; c < 127; ++c) {
    FT_Load_Char(face, FT_ULong(c), FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP);
    Pen pen;
    FT_Outline_Decompose(&face->glyph->outline, &functions, &pen);
    std::string text(1, digit(face->glyph->linearHoriAdvance / 65536.0));
    for (const auto& loop : pen.loops) {
      text += ' ';
      for (const Point& p : loop) text += std::string(1, digit(p.x / 64.0)) + digit(p.y / 64.0 + 16);
    }
    std::printf("    R\"g(%s)g\",\n", text.c_str());
  }
  std::printf("};\n\n}  // namespace epafi\n");
}
