/// @file pair_methods.h  Methods of the pair table by name, without its templates.
#pragma once
#include <string>
#include <string_view>

namespace epafi {

/// closed-form, sat, gjk-epa, mesh or none, of two shapes by name; none where a name is not in the list.
const char* pair_method(std::string_view a, std::string_view b);

/// One line per ordered pair: `sphere box closed-form`.
std::string describe_pair_table();

}  // namespace epafi
