// Writes the outlines of characters of DejaVu Sans, flattened to polygons: viz_export/view/glyphs.h (printable ASCII)
// and viz_export/view/more_glyphs.h (Latin, Greek, Cyrillic letters, signs).
//   g++ -O1 tools/font_outlines.cpp $(pkg-config --cflags --libs freetype2) -o font_outlines
//   ./font_outlines /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf > viz_export/view/glyphs.h
//   ./font_outlines /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf more > viz_export/view/more_glyphs.h
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

constexpr const char* ascii_head =
    "/// @file glyphs.h  Outlines of the printable ASCII characters, made by tools/font_outlines.cpp from DejaVu Sans\n"
    "/// (Bitstream Vera and public domain; free to use, change and pass on). Of each character: its advance, then\n"
    "/// polygons divided by blanks; a point is two characters, x and y + 16 in 1/64 of the em, counted from '0'.\n"
    "#pragma once\n\nnamespace epafi {\n\ninline constexpr const char* glyph_outlines[95] = {\n";
constexpr const char* more_head =
    "/// @file more_glyphs.h  Letters and signs beyond ASCII in the form and from the font of glyphs.h, each behind "
    "its\n"
    "/// code point in four hexadecimal digits, ascending.\n"
    "#pragma once\n\nnamespace epafi {\n\ninline constexpr const char* more_glyphs[] = {\n";

std::string outline_of(FT_Face face, unsigned code) {
  const FT_Outline_Funcs functions{move_to, line_to, conic_to, cubic_to, 0, 0};
  FT_Load_Char(face, FT_ULong(code), FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP);
  Pen pen;
  FT_Outline_Decompose(&face->glyph->outline, &functions, &pen);
  std::string text(1, digit(face->glyph->linearHoriAdvance / 65536.0));
  for (const auto& loop : pen.loops) {
    text += ' ';
    for (const Point& p : loop) text += std::string(1, digit(p.x / 64.0)) + digit(p.y / 64.0 + 16);
  }
  return text;
}

// Latin-1 and Extended-A, Greek, Cyrillic, then punctuation, raised and lowered digits, arrows and signs of formulas.
constexpr unsigned ranges[][2] = {
    {0xA0, 0x17F},    {0x384, 0x386},   {0x388, 0x38A},   {0x38C, 0x38C},   {0x38E, 0x3A1},   {0x3A3, 0x3CE},
    {0x3D1, 0x3D1},   {0x3D5, 0x3D5},   {0x400, 0x45F},   {0x490, 0x491},   {0x2010, 0x2015}, {0x2018, 0x201E},
    {0x2020, 0x2022}, {0x2026, 0x2026}, {0x2030, 0x2030}, {0x2032, 0x2033}, {0x2070, 0x2071}, {0x2074, 0x207F},
    {0x2080, 0x208E}, {0x20AC, 0x20AC}, {0x2126, 0x2126}, {0x212B, 0x212B}, {0x2190, 0x2194}, {0x2202, 0x2202},
    {0x2206, 0x2207}, {0x2211, 0x2212}, {0x221A, 0x221A}, {0x221D, 0x221E}, {0x222B, 0x222B}, {0x2248, 0x2248},
    {0x2260, 0x2260}, {0x2264, 0x2265}};

// Some marks lie beyond what a character holds.
bool is_printable(const std::string& text) {
  for (const char c : text)
    if (c < ' ' || c > '~') return false;
  return true;
}

int main(int count, char** argv) {
  FT_Library library;
  FT_Face face;
  FT_Init_FreeType(&library);
  FT_New_Face(library, argv[1], 0, &face);
  FT_Set_Pixel_Sizes(face, 0, 64);
  const bool more = count > 2;
  std::printf("%s", more ? more_head : ascii_head);
  for (unsigned c = 32; !more && c < 127; ++c) std::printf("    R\"g(%s)g\",\n", outline_of(face, c).c_str());
  for (const auto& range : ranges)
    for (unsigned c = range[0]; more && c <= range[1]; ++c)
      if (const std::string text = outline_of(face, c); FT_Get_Char_Index(face, c) != 0 && is_printable(text))
        std::printf("    R\"g(%04X%s)g\",\n", c, text.c_str());
  std::printf("};\n\n}  // namespace epafi\n");
}
