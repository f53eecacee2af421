/// @file document.h  A Markdown page as something that can be tested: its shell blocks run as written, its listings
/// equal the files they name, the numbers of its tables are read again from what the commands left behind.
///
///   ```sh             run by bash, from a folder that holds nothing but the program and the tree's scenes, docs,
///   examples
///   ```sh slow        the same, only where slow commands are asked for
///   ```sh elsewhere   not run here: needs another machine
///   ```toml PATH      must stand in the file PATH of the tree, word for word (also cpp, cmake, bash)
///   | ... | read from | value | within |    rows: `FILE: NAME` of a .json, `FILE[ROW]: COLUMN` of a .csv; within: "2
///   %",
///                                           an absolute difference, "at most" or "at least"
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace epafi::support {

struct FencedBlock {
  std::string info;  ///< what follows the fence
  std::string text;
  int line = 0;
};

struct TableRow {
  std::vector<std::string> cells;  ///< without blanks around and without backticks
  int line = 0;
};

struct MarkdownPage {
  std::string path;
  std::vector<FencedBlock> blocks;
  std::vector<TableRow> figures;  ///< rows of tables with a column `read from`; cells: read from, value, within
};

[[nodiscard]] std::string read_text(const std::filesystem::path& path);
[[nodiscard]] MarkdownPage read_page(const std::filesystem::path& path);

/// Runs the page and checks its listings and figures with Catch's CHECK. Returns the number of commands and figures.
struct PageRun {
  int commands = 0, figures = 0, listings = 0;
};
PageRun run_page(const std::string& path_in_tree, bool slow = false);

}  // namespace epafi::support
