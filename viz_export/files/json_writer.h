/// @file json_writer.h  JSON out, value by value: numbers so that they read back to the same bits, non-finite ones as
/// null.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace epafi {

/// Text with quotes, escaped for JSON; bytes that are not UTF-8 become U+FFFD.
std::string json_text(std::string_view text);
/// Shortest decimal form that reads back to the same bits.
std::string json_number(double value);

/// Writes one document, indented by two spaces. Calls must nest: begin, then members, then end.
class JsonWriter {
 public:
  JsonWriter& begin_object();
  JsonWriter& end_object();
  JsonWriter& begin_array();
  JsonWriter& end_array();
  JsonWriter& key(std::string_view name);
  JsonWriter& value(double v);
  JsonWriter& value(std::uint64_t v);
  JsonWriter& value(std::int64_t v);
  JsonWriter& value(int v) { return value(static_cast<std::int64_t>(v)); }
  JsonWriter& value(bool v);
  JsonWriter& value(std::string_view v);
  JsonWriter& value(const char* v) { return value(std::string_view(v)); }
  template <class T>
  JsonWriter& member(std::string_view name, const T& v) {
    return key(name).value(v);
  }
  /// Absent where there is no value.
  template <class T>
  JsonWriter& member(std::string_view name, const std::optional<T>& v) {
    return v ? member(name, *v) : *this;
  }
  /// The document; complete when every begin has its end.
  const std::string& text() const { return text_; }

 private:
  void separate();
  JsonWriter& raw(std::string_view token);
  JsonWriter& open(char bracket);
  JsonWriter& close(char bracket);
  std::string text_;
  std::vector<bool> has_members_;  ///< of each open bracket
  bool after_key_ = false;
};

}  // namespace epafi
