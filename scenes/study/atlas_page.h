/// @file atlas_page.h  Pages of the atlas: a person writes what a study says, the command writes what it measured
/// between two marks of the same page, and the index of all pages.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "scenes/study/chart.h"
#include "scenes/study/limits.h"

namespace epafi {

/// Command, pictures (file names beside the page), table and verdict of a study, as Markdown.
std::string measured_text(const Chart& chart, const std::string& stem, const std::vector<std::string>& pictures);
std::string measured_text(const LimitMap& map, const std::string& stem, const std::vector<std::string>& pictures);

/// The page with the text between its marks replaced; a page without marks, or none, is begun with the title.
std::string page_with(const std::string& page, const std::string& title, const std::string& measured);

/// README.md of the atlas: every study of a folder, charts then maps, with title and page.
std::string atlas_index(const std::filesystem::path& studies);

}  // namespace epafi
