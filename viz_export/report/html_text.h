/// @file html_text.h  Text and bytes inside HTML pages.
#pragma once
#include <string>

namespace epafi {

/// < > & " as entities.
[[nodiscard]] std::string html_escaped(const std::string& text);

/// JSON inside <script>: "<" as an escape, so that nothing in it ends the element.
[[nodiscard]] std::string script_escaped(const std::string& json);

[[nodiscard]] std::string base64(const std::string& bytes);

}  // namespace epafi
