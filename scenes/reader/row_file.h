/// @file row_file.h  Tables of bodies as programs write them: CSV with commas, semicolons or tabs, columns between
/// blanks, text exports of YADE, dumps of LAMMPS and LIGGGHTS (their last frame). The meaning of a column follows from
/// its name in the file, such as "Radius[m]", or from names in the scene.
#pragma once
#include <fstream>
#include <istream>
#include <memory>
#include <optional>

#include "scenes/reader/table_reader.h"

namespace epafi {

class RowFile {
 public:
  struct Cell {
    std::string text;
    Place place;
  };
  struct Column {
    std::string name;     ///< Epafi's name, "" for a column that is not used
    std::string written;  ///< in the file
    Place place;
    double factor = 1.0;  ///< to SI
  };
  /// Names of columns that a body may have.
  static const std::vector<std::string>& known();

  /// path: of the file, place: where the scene names it; columns: names that the scene gives, "-" passes one over.
  /// Throws FileError: an .h5 file without such columns.
  RowFile(Reading& reading, std::string path, Place place, std::vector<std::string> columns);

  /// Finds the columns. False after an error.
  bool open();
  const std::vector<Column>& columns() const { return columns_; }
  bool has_column(const std::string& name) const;
  /// Reads the cells of the next row. False at the end, or after an error, which is reported.
  bool next(std::vector<Cell>& cells);
  /// Upper bound of the number of remaining rows.
  std::size_t rows_ahead();

 private:
  struct Frame;

  bool next_line();
  bool open_dump();
  bool open_text();
  bool read_units(const std::string& name);
  bool check_count();
  std::vector<Cell> split(std::size_t begin = 0) const;
  void name_columns(const std::vector<Cell>& header, bool strict);
  Column column_of(const Cell& cell, bool strict) const;
  bool named_by_scene(std::size_t count);
  bool error(const Place& at, const std::string& text) const;

  Reading& reading_;
  std::string path_;
  Place place_;
  std::vector<std::string> wanted_;
  std::unique_ptr<std::istream> in_;  ///< the file, or its rows as text
  std::string line_;
  int number_ = 0;          ///< of line_
  char separator_ = ' ';    ///< blank: any run of blanks
  bool kept_line_ = false;  ///< line_ is the first row
  bool is_dump_ = false;
  std::optional<std::size_t> announced_;  ///< rows of a dump's last frame
  int announced_line_ = 0;
  std::size_t rows_ = 0;
  double length_ = 1.0, time_ = 1.0;  ///< units of a dump [m], [s]
  std::vector<Column> columns_;
};

}  // namespace epafi
