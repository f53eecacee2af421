#include "engine/units/nearest.h"

#include <algorithm>

namespace epafi {
namespace {

constexpr std::size_t longest_compared = 64;  // the cost is quadratic; no key is longer

std::string folded(std::string_view word) {
  std::string out(word);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == '-') c = '_';
  }
  return out;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates) {
  if (word.size() > longest_compared) return std::nullopt;
  const auto closest = [&](auto&& admissible) {
    std::optional<std::string> best;
    std::size_t best_distance = longest_compared;
    for (const auto& candidate : candidates) {
      const std::size_t distance = edit_distance(word, candidate);
      if (distance >= best_distance || !admissible(candidate, distance)) continue;
      best = candidate;
      best_distance = distance;
    }
    return best;
  };
  // "Mpa" is MPa, not mPa: among words equal but for case the distance decides too
  auto same = closest([&](const std::string& c, std::size_t) { return folded(c) == folded(word); });
  if (same) return same;
  return closest([&](const std::string& c, std::size_t d) { return 3 * d <= std::max(word.size(), c.size()); });
}

std::string suggestion(std::string_view word, const std::vector<std::string>& candidates, std::string_view otherwise) {
  if (const auto near = nearest(word, candidates)) return "; did you mean '" + *near + "'?";
  if (candidates.empty()) return {};
  std::string all;
  for (const auto& candidate : candidates) all += (all.empty() ? "" : ", ") + candidate;
  return "; " + std::string(otherwise) + ": " + all;
}

}  // namespace epafi
