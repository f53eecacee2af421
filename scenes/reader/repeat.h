/// @file repeat.h  `repeat` of a table: n copies, or l m n of them, with indices i, j, k in their expressions. A name
/// such as "ball[i + 1]" or "grid[i, j]" is that of one copy of a repeated body; expressions of i, j or k in the
/// brackets are evaluated.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "scenes/reader/table_reader.h"

namespace epafi {

using Index3 = std::array<std::size_t, 3>;

/// An expression somewhere in the value that uses i, j or k.
bool uses_index(const Node& node);

/// The members that `keep` takes, as a table of its own.
Node part_of(const Node& table, const std::function<bool(const Member&)>& keep);

/// 1 to 3 counts; empty where the table is not repeated or repeats wrongly, which is reported.
std::vector<std::size_t> read_repeat(Reading& reading, const Node& item, const std::string& label,
                                     const std::vector<Field>& fields);

/// i, j, k of expressions from here on.
void set_indices(Reading& reading, const Index3& index, std::size_t dimensions);

/// Visits every copy of the table, without `repeat`, its name as NAME[i] (`other_name` where none is written). A table
/// that is not repeated is its only copy. Ends with the first copy that is wrong: the others would say the same.
void each_copy(Reading& reading, const Node& item, const std::string& label, const std::vector<Field>& fields,
               const std::string& other_name, const std::function<void(const Node&)>& visit);

}  // namespace epafi
