/// @file report_table.h  Tables of HTML reports, by column: heads stand over what they head, numbers to the right.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace epafi {

struct TableColumn {
  std::string head;
  std::vector<std::string> cells{};  ///< empty where there is nothing to say
  bool says_something() const;
  bool differs() const;     ///< its cells are not all the same
  bool is_numeric() const;  ///< it says numbers only
  void shorten();           ///< numbers to six digits, whole ones as they are; nothing where it says others
};

/// The first `most` rows, in a box that is moved sideways where they are wide; `empty` stands for what is not said.
std::string table_html(const std::vector<TableColumn>& columns, std::size_t most, const std::string& empty);

/// A CSV file with its name above, numbers to six digits; what is the same in all rows, or in none, stands in one line
/// below. A long one is folded up, a very long one cut, and says so.
std::string csv_html(const std::filesystem::path& path);

}  // namespace epafi
