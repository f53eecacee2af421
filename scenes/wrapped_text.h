/// @file wrapped_text.h  Text for a terminal: words in lines of a width.
#pragma once
#include <sstream>
#include <string>
#include <vector>

namespace epafi {

/// The words of a text in lines of at most `width` characters; a longer word has a line of its own. At least one line.
inline std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::istringstream words(text);
  std::vector<std::string> lines(1);
  for (std::string word; words >> word;) {
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > width) lines.emplace_back();
    if (!lines.back().empty()) lines.back() += ' ';
    lines.back() += word;
  }
  return lines;
}

}  // namespace epafi
