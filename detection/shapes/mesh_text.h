/// @file mesh_text.h  Lines and words of a mesh file in text form, with the place for messages.
#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "engine/state/types.h"
#include "engine/units/error.h"

namespace epafi {

/// Walks over a text line by line, and over a line word by word. Views into the text: it must outlive the reader.
class MeshText {
 public:
  /// A byte order mark at the beginning and zeros at the end are no text. comments: '#' begins one, and a line that
  /// ends with a backslash goes on in the next (OBJ). before: lines of the file in front of the text.
  MeshText(std::string_view text, std::string file, bool comments = false, int before = 0)
      : text_(text.substr(0, text.find_last_not_of('\0') + 1)),
        file_(std::move(file)),
        comments_(comments),
        number_(before) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (text_.starts_with(mark)) at_ = mark.size();
  }

  bool next_line() {
    if (at_ >= text_.size()) return false;
    const auto end = std::min(text_.find_first_of("\n\r", at_), text_.size());
    line_ = text_.substr(at_, end - at_);
    if (comments_) line_ = line_.substr(0, line_.find('#'));
    const bool two = end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n';
    at_ = end + (two ? 2 : 1);
    column_ = 0;
    ++number_;
    return true;
  }
  /// The next word of the line, "" at its end.
  std::string_view word() {
    std::string_view found = word_here();
    while (comments_ && found == "\\" && next_line()) found = word_here();
    return found;
  }
  std::string_view line() const { return line_; }
  std::size_t offset() const { return at_; }  ///< of the next line [bytes]
  /// is_measure: its digits tell how far the file rounds; else it is an index or a count.
  double number(bool is_measure = true) {
    const auto w = word();
    if (w.empty()) fail("a number is missing");
    const auto digits = w.starts_with('+') ? w.substr(1) : w;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::result_out_of_range) fail(fmt::format("'{}' is outside the range of numbers", shown(w)));
    if (error != std::errc{} || end != digits.data() + digits.size())
      fail(fmt::format("expected a number, found '{}'", shown(w)));
    if (!std::isfinite(value)) fail(fmt::format("'{}' is not a finite number", shown(w)));
    if (is_measure) note_digits(digits, value);
    return value;
  }
  /// How far its rounding may have put the largest of the numbers: half of the last digit they are written to, and no
  /// less than single precision where all may be such numbers. 0: fewer than 5 digits are meant so, over 15 are all.
  double written_precision() const {
    if (most_digits_ < 5 || most_digits_ > 15) return 0.0;
    // equally many decimals, or equally many digits (%g, %e): then those of the largest number count
    const double unit = last_digit_ == finest_digit_ ? last_digit_ : unit_of(largest_, most_digits_);
    return std::max(0.5 * unit, most_digits_ <= 9 || all_single_ ? std::ldexp(largest_, -24) : 0.0);
  }
  Vec3 point() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  void expect(std::string_view what) {
    if (const auto w = word(); !same_word(w, what)) fail(fmt::format("expected '{}', found {}", what, named(w)));
  }
  void expect_end() {
    if (const auto w = word(); !w.empty()) fail(fmt::format("expected the end of the line, found '{}'", shown(w)));
  }
  /// Whether two words differ in capitals alone.
  static bool same_word(std::string_view a, std::string_view b) {
    const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    return std::ranges::equal(a, b, [&](char x, char y) { return small(x) == small(y); });
  }
  [[noreturn]] void fail(const std::string& text) const {
    throw SceneError(text, {file_, number_, static_cast<int>(word_begin_) + 1});
  }
  static std::string named(std::string_view w) {
    return w.empty() ? "the end of the line" : fmt::format("'{}'", shown(w));
  }
  /// Printable and short: a broken file may hold anything.
  static std::string shown(std::string_view w) {
    std::string out;
    for (const char c : w.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
    if (w.size() > 40) out.append("...");
    return out;
  }

 private:
  std::string_view word_here() {
    constexpr std::string_view blank = " \t\r\v\f";
    const auto begin = std::min(line_.find_first_not_of(blank, column_), line_.size());
    const auto end = std::min(line_.find_first_of(blank, begin), line_.size());
    word_begin_ = begin;
    column_ = end;
    return line_.substr(begin, end - begin);
  }
  /// Of the last of so many digits of a number.
  static double unit_of(double value, int digits) {
    return std::pow(10.0, std::floor(std::log10(value)) + 1.0 - digits);
  }
  /// Of fractions: 0.012345 has five digits, 1.2e-5 two.
  void note_digits(std::string_view w, double value) {
    largest_ = std::max(largest_, std::abs(value));
    const auto mantissa = w.substr(0, std::min(w.find_first_of("eE"), w.size()));
    const auto dot = mantissa.find('.');
    if (dot == mantissa.npos) return;
    const std::size_t begin = mantissa.find_first_not_of("-0.");
    if (begin == mantissa.npos) return;
    const auto digits = static_cast<int>(mantissa.size() - begin - (begin < dot ? 1 : 0));
    if (digits < 5) return;  // too few to tell; zeros at the end may have been left out
    const double decimals = static_cast<double>(mantissa.size() - dot - 1);
    int exponent = 0;
    if (mantissa.size() + 1 < w.size()) {
      const auto power = w.substr(mantissa.size() + (w[mantissa.size() + 1] == '+' ? 2 : 1));
      std::from_chars(power.data(), power.data() + power.size(), exponent);
    }
    const double unit = std::pow(10.0, exponent - decimals);
    const double off = std::abs(value - static_cast<double>(static_cast<float>(value)));
    all_single_ = all_single_ && off <= 0.5001 * unit;
    if (digits < most_digits_) return;
    const bool is_first = digits > most_digits_;
    last_digit_ = std::max(is_first ? 0.0 : last_digit_, unit);
    finest_digit_ = std::min(is_first ? unit : finest_digit_, unit);
    most_digits_ = digits;
  }

  std::string_view text_, line_;
  std::string file_;
  bool comments_ = false;
  std::size_t at_ = 0, column_ = 0, word_begin_ = 0;
  int number_ = 0;
  int most_digits_ = 0;
  double last_digit_ = 0.0, finest_digit_ = 0.0;  ///< of the coarsest and the finest number of so many digits
  double largest_ = 0.0;
  bool all_single_ = true;  ///< each number is what one of single precision is written as
};

}  // namespace epafi
