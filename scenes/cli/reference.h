/// @file reference.h  Reference pages in Markdown from the registry: what the parser reads is what the page says.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "scenes/reader/registry.h"

namespace epafi {

/// File names and texts: shapes, laws, solvers, measures, broad phases and schemes, keys of scenes and of patch cases.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> reference_pages(const Registry& registry);

/// The page of error messages, from scenes that are wrong on purpose: their first line is `# expect: <message>`.
[[nodiscard]] std::string messages_page(const std::filesystem::path& broken_scenes);

}  // namespace epafi
