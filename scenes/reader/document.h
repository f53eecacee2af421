/// @file document.h  A TOML text as a tree of nodes with places: includes merged, overrides applied. The only door to
/// toml++. Knows no key of a scene but `include`; runs nothing, reads only the files that are named.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "engine/units/error.h"

namespace epafi {

struct Member;

/// One value. Numbers keep whether they were written as integers.
struct Node {
  enum class Type { boolean, integer, real, text, date, array, table };
  Type type = Type::table;
  bool boolean = false;
  long long integer = 0;
  double real = 0.0;            ///< also set for integers
  std::string text;             ///< of a value given by --set as it was written, whatever its type
  std::vector<Node> items;      ///< of an array
  std::vector<Member> members;  ///< of a table, in the order of the file
  Place place;                  ///< of the value; of a table its header or brace
  std::size_t stage = 0;        ///< of a table that a [[stage]] has added to a list
  bool quoted_inline = false;   ///< text on one line: a column inside it is place.column + 1 + offset

  const Node* find(std::string_view key) const;
  bool is_number() const { return type == Type::integer || type == Type::real; }
  bool is_array_of_tables() const;
};

struct Member {
  std::string key;
  Place place;  ///< of the key
  Node value;
};

/// "a number", "a text", "a table" ...
const char* type_name(Node::Type type);

/// The value as TOML text, on one line.
std::string to_toml(const Node& node);

struct Document {
  Node root;
  std::string text;               ///< of all files and overrides, in the order they were read
  std::vector<Problem> problems;  ///< syntax, includes, overrides
  bool failed = false;            ///< nothing to go on with
};

/// Reads a file, its includes and the overrides "KEY.PATH=VALUE" (VALUE is TOML, else a bare word).
/// KEY.PATH steps through tables by key and through arrays by index or by the `name` of a table in them.
Document load_document(const std::string& path, const std::vector<std::string>& overrides);
Document parse_document(const std::string& text, const std::string& file, const std::vector<std::string>& overrides);

/// Sets KEY.PATH of `root` as --set does, with "KEY.PATH=VALUE".
void set_value(Node& root, const std::string& override_text, std::vector<Problem>& problems);

/// A file name written at `place`, relative to the folder of the file it stands in (of `main_file` for overrides).
std::string resolve_path(const std::string& name, const Place& place, const std::string& main_file);

/// The place of a value given by --set.
bool is_override(const Place& place);

}  // namespace epafi
