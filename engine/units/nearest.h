/// @file nearest.h  The word of a list that a user most likely meant (Damerau 1964, Levenshtein 1966: optimal string
/// alignment).
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace epafi {

/// Insertions, deletions, substitutions and swaps of neighbours that turn a into b.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate equal but for case or for - and _, else the closest within a third of the longer length; empty if
/// none. Ties go to the earlier candidate.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates);

/// "; did you mean 'x'?" or "; <otherwise>: a, b, c" or nothing when there are no candidates.
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates, std::string_view otherwise);

}  // namespace epafi
