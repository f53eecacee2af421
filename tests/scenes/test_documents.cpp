// Every command of README and tutorials runs as written; what they quote is read again from what the commands wrote.
#include "tests/support/document.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/support/catch.h"
#include "viz_export/files/json_reader.h"

namespace fs = std::filesystem;

namespace epafi::support {

std::string read_text(const fs::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

namespace {

std::string trimmed(std::string text) {
  std::erase(text, '`');
  const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == text.npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::string cell;
  std::stringstream in(line.substr(1));
  while (std::getline(in, cell, '|')) cells.push_back(trimmed(cell));
  return cells;
}

std::vector<std::string> csv_cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line)
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  return cells;
}

/// `FILE.csv[ROW]: COLUMN`, rows counted from 0 below the header, from the end where negative.
double from_csv(const fs::path& file, int row, const std::string& column) {
  std::ifstream in(file);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(in, line);) rows.push_back(csv_cells(line));
  REQUIRE(rows.size() > 1);
  const auto at = static_cast<std::size_t>(row < 0 ? static_cast<int>(rows.size()) + row : row + 1);
  REQUIRE(at < rows.size());
  for (std::size_t k = 0; k < rows[0].size(); ++k)
    if (rows[0][k] == column) return std::stod(rows[at].at(k));
  FAIL("no column " << column << " in " << file);
  return NAN;
}

double figure_of(const fs::path& folder, const std::string& place) {
  const auto colon = place.find(": ");
  REQUIRE(colon != place.npos);
  std::string file = place.substr(0, colon);
  const std::string name = place.substr(colon + 2);
  int row = 0;
  if (const auto bracket = file.find('['); bracket != file.npos) {
    row = std::stoi(file.substr(bracket + 1));
    file = file.substr(0, bracket);
  }
  INFO(folder / file);
  REQUIRE(fs::exists(folder / file));
  if (fs::path(file).extension() == ".csv") return from_csv(folder / file, row, name);
  const auto number = read_json(folder / file).number(name);
  INFO(name);
  REQUIRE(number.has_value());
  return *number;
}

void check_figure(const fs::path& folder, const MarkdownPage& page, const TableRow& row) {
  INFO(page.path << ":" << row.line << ": " << row.cells[0]);
  const double seen = figure_of(folder, row.cells[0]), quoted = std::stod(row.cells[1]);
  const std::string& within = row.cells[2];
  if (within == "at most") {
    CHECK(seen <= quoted);
  } else if (within == "at least") {
    CHECK(seen >= quoted);
  } else {
    const double number = std::stod(within);
    const double margin = within.find('%') != within.npos ? 0.01 * number * std::abs(quoted) : number;
    INFO("seen " << seen << ", quoted " << quoted);
    CHECK(std::abs(seen - quoted) <= margin);
  }
}

/// An empty folder with the program under the name that the pages use, and what of the tree they name.
fs::path make_folder(const std::string& page) {
  std::string name = page;
  for (char& c : name) c = c == '/' || c == '.' ? '-' : c;
  const fs::path folder = fs::temp_directory_path() / ("epafi-page-" + std::to_string(::getpid()) + "-" + name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  for (const char* part : {"scenes", "docs", "examples", "tools"})
    if (fs::exists(fs::path(EPAFI_SOURCE_DIR) / part))
      fs::create_symlink(fs::path(EPAFI_SOURCE_DIR) / part, folder / part);
  fs::create_symlink(EPAFI_BINARY_DIR, folder / "build");
  fs::create_symlink(fs::path(EPAFI_BINARY_DIR) / "bin/epafi", folder / "epafi");
  return folder;
}

/// Lines that are more than a comment.
int commands_in(const std::string& script) {
  int count = 0;
  std::stringstream in(script);
  for (std::string line; std::getline(in, line);) count += !line.empty() && line[0] != '#';
  return count;
}

void run_block(const fs::path& folder, const MarkdownPage& page, const FencedBlock& block) {
  const fs::path script = folder / ".block.sh", log = folder / ".block.log";
  std::ofstream(script) << "set -euo pipefail\n" << block.text;
  const std::string command = "cd '" + folder.string() + "' && bash .block.sh > .block.log 2>&1";
  const int status = std::system(command.c_str());
  INFO(page.path << ":" << block.line << ":\n" << block.text << "\n" << read_text(log));
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
}

}  // namespace

MarkdownPage read_page(const fs::path& path) {
  MarkdownPage page{path.string(), {}, {}};
  std::ifstream in(path);
  REQUIRE(in.good());
  bool fenced = false;
  std::vector<std::size_t> columns;  // of the table we are in: read from, value, within
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.rfind("```", 0) == 0) {
      if (!fenced) page.blocks.push_back({line.substr(3), "", number});
      fenced = !fenced;
    } else if (fenced) {
      page.blocks.back().text += line + "\n";
    } else if (line.rfind("|", 0) == 0) {
      const auto cells = cells_of(line);
      if (columns.empty()) {
        for (const char* name : {"read from", "value", "within"})
          for (std::size_t k = 0; k < cells.size(); ++k)
            if (cells[k] == name) columns.push_back(k);
        if (columns.size() != 3) columns = {std::string::npos};  // another table
      } else if (columns.size() == 3 && line.rfind("|---", 0) != 0) {
        page.figures.push_back({{cells.at(columns[0]), cells.at(columns[1]), cells.at(columns[2])}, number});
      }
    } else {
      columns.clear();
    }
  }
  REQUIRE_FALSE(fenced);
  return page;
}

PageRun run_page(const std::string& path, bool slow) {
  const MarkdownPage page = read_page(fs::path(EPAFI_SOURCE_DIR) / path);
  const fs::path folder = make_folder(path);
  PageRun run;
  for (const FencedBlock& block : page.blocks) {
    const auto space = block.info.find(' ');
    const std::string language = block.info.substr(0, space);
    const std::string rest = space == block.info.npos ? "" : block.info.substr(space + 1);
    if (language == "sh") {
      if (rest == "elsewhere" || (rest == "slow" && !slow)) continue;
      REQUIRE((rest.empty() || rest == "slow"));
      run_block(folder, page, block);
      run.commands += commands_in(block.text);
    } else if (!rest.empty()) {
      INFO(page.path << ":" << block.line << ": is not what stands in " << rest);
      CHECK(read_text(fs::path(EPAFI_SOURCE_DIR) / rest).find(block.text) != std::string::npos);
      ++run.listings;
    }
  }
  for (const TableRow& row : page.figures) {
    check_figure(folder, page, row);
    ++run.figures;
  }
  fs::remove_all(folder);
  return run;
}

}  // namespace epafi::support

using epafi::support::run_page;

TEST_CASE("a page is read: fences, listings, tables of figures", "[scenes][documents]") {
  const fs::path file = fs::temp_directory_path() / ("epafi-page-" + std::to_string(::getpid()) + ".md");
  std::ofstream(file)
      << "# x\n```sh\ntrue\n```\n| a | read from | value | within |\n|---|---|---|---|\n| q | `f: k` | 2 | 1 % |\n"
         "\n| a | b |\n|---|---|\n| 1 | 2 |\n```toml a/b\nx\n```\n";
  const auto page = epafi::support::read_page(file);
  fs::remove(file);
  REQUIRE(page.blocks.size() == 2);
  CHECK(page.blocks[0].text == "true\n");
  CHECK(page.blocks[1].info == "toml a/b");
  REQUIRE(page.figures.size() == 1);
  CHECK(page.figures[0].cells == std::vector<std::string>{"f: k", "2", "1 %"});
}

namespace {
void check_tutorial(const std::string& name, int commands, int figures) {
  const auto run = run_page("docs/tutorials/" + name + ".md");
  CHECK(run.commands >= commands);
  CHECK(run.figures >= figures);
  CHECK(run.listings >= 1);
}
}  // namespace

TEST_CASE("tutorial 1 runs as written: first impact", "[scenes][documents]") {
  check_tutorial("01_first_impact", 2, 4);
}
TEST_CASE("tutorial 2 runs as written: sand in a hopper", "[scenes][documents]") { check_tutorial("02_hopper", 2, 3); }
TEST_CASE("tutorial 3 runs as written: stack and friction", "[scenes][documents]") { check_tutorial("03_stack", 2, 3); }
TEST_CASE("tutorial 4 runs as written: a pile of stones", "[scenes][documents]") { check_tutorial("04_stones", 2, 3); }
TEST_CASE("tutorial 5 runs as written: restart, sweep, Slurm", "[scenes][documents]") {
  check_tutorial("05_sweep", 3, 2);
}
TEST_CASE("tutorial 6 runs as written: chart and limits", "[scenes][documents]") { check_tutorial("06_chart", 2, 3); }
TEST_CASE("tutorial 7 runs as written: wheel on rail", "[scenes][documents]") { check_tutorial("07_wheel_rail", 2, 3); }
TEST_CASE("tutorial 8 runs as written: a law in one file", "[scenes][documents]") {
  check_tutorial("08_new_law", 1, 1);
}
TEST_CASE("tutorial 9 runs as written: more than one act", "[scenes][documents]") { check_tutorial("09_acts", 3, 4); }
TEST_CASE("the README's commands run as written", "[scenes][documents]") { CHECK(run_page("README.md").commands >= 2); }
TEST_CASE("the README's long commands run as written", "[scenes][documents][slow]") {
  CHECK(run_page("README.md", true).commands >= 3);
}

TEST_CASE("files that the theory notes and tutorials name are there", "[scenes][documents]") {
  const fs::path root(EPAFI_SOURCE_DIR);
  int named = 0;
  for (const char* folder : {"docs/theory", "docs/tutorials"})
    for (const auto& page : fs::directory_iterator(root / folder)) {
      std::stringstream text(epafi::support::read_text(page.path()));
      std::string outside, word;  // what stands between backticks is every second piece
      while (std::getline(text, outside, '`') && std::getline(text, word, '`')) {
        const std::string ending = fs::path(word).extension();
        if (word.find_first_of(" <\n") != word.npos || word.find('/') == word.npos || word.rfind("out/", 0) == 0)
          continue;
        if (ending != ".h" && ending != ".cpp" && ending != ".md" && ending != ".toml") continue;
        INFO(page.path() << ": " << word);
        CHECK(fs::exists(root / word));
        ++named;
      }
    }
  CHECK(named > 50);
}
