/// @file toml_text.h  TOML text to nodes: what toml++ does, behind one .cpp (linked, not header-only: 1.5 s instead of
/// 7 s to compile).
#pragma once
#include <string>

#include "scenes/reader/document.h"

namespace epafi {

struct ParsedToml {
  Node root;
  Problem problem;  ///< of syntax; its text is empty when there is none
};

ParsedToml parse_toml(const std::string& text, const std::string& file);

/// One value as it stands behind a key; what is no TOML value is a text.
Node parse_toml_value(const std::string& text, const Place& place);

/// A basic string with what must be escaped escaped.
std::string quote_toml(const std::string& text);

}  // namespace epafi
