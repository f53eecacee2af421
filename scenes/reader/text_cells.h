/// @file text_cells.h  Lines, cells and numbers of tables in text files.
#pragma once
#include <istream>
#include <optional>
#include <string>
#include <vector>

namespace epafi {

struct TextCell {
  std::string text;
  int column = 1;  ///< where it begins in its line
};

/// The next line without its end, without zeros that filled a block, and the first without a byte order mark. number:
/// of the line before, grows by one.
bool next_text_line(std::istream& in, std::string& line, int& number);

/// Cells between separators, without blanks around them; quotes keep a separator, two in quotes are one. Separator ' ':
/// words between any blanks.
std::vector<TextCell> cells_of_line(const std::string& line, char separator = ',', std::size_t begin = 0);

/// A finite number, a plus before it allowed.
std::optional<double> read_number(const std::string& text);

}  // namespace epafi
