#include "laws/nonsmooth/coloring.h"

#include <algorithm>
#include <array>
#include <bit>

namespace epafi {

void Coloring::update(const ContactProblem& problem) {
  found_.clear();
  for (std::uint32_t i = 0; i < problem.size(); ++i) {
    if (!found_.empty() && found_.back().a == problem.a[i] && found_.back().b == problem.b[i]) {
      ++found_.back().count;
    } else {
      found_.push_back({problem.a[i], problem.b[i], i, 1});
    }
  }
  free_found_.resize(problem.inverse_mass.size());
  for (std::size_t s = 0; s < free_found_.size(); ++s) free_found_[s] = problem.inverse_mass[s] > 0.0;
  const auto same_pair = [](const ContactGroup& p, const ContactGroup& q) { return p.a == q.a && p.b == q.b; };
  const bool same = free_found_ == free_ &&
                    std::equal(found_.begin(), found_.end(), canonical_.begin(), canonical_.end(), same_pair);
  canonical_.swap(found_), free_.swap(free_found_);
  if (!same) paint(problem);
  std::array<std::size_t, max_colors + 1> next{};
  std::copy_n(begin_.begin(), colors(), next.begin());
  groups_.resize(canonical_.size());
  for (std::size_t g = 0; g < canonical_.size(); ++g) groups_[next[color_[g]]++] = canonical_[g];
}

void Coloring::paint(const ContactProblem& problem) {
  used_.assign(problem.inverse_mass.size(), 0);
  color_.resize(canonical_.size());
  std::array<std::size_t, max_colors + 1> count{};
  for (std::size_t g = 0; g < canonical_.size(); ++g) {
    const ContactGroup& group = canonical_[g];
    const bool free_a = problem.is_free(group.a), free_b = problem.is_free(group.b);
    const std::uint64_t taken = (free_a ? used_[group.a] : 0) | (free_b ? used_[group.b] : 0);
    const auto color = static_cast<std::size_t>(std::countr_one(taken));
    color_[g] = static_cast<std::uint8_t>(std::min(color, max_colors));
    ++count[color_[g]];
    if (color >= max_colors) continue;  // the bit of the overflow colour is never set
    if (free_a) used_[group.a] |= std::uint64_t{1} << color;
    if (free_b) used_[group.b] |= std::uint64_t{1} << color;
  }
  has_overflow_ = count[max_colors] > 0;
  const auto last = std::find_if(count.rbegin(), count.rend(), [](std::size_t n) { return n > 0; });
  const auto colors = static_cast<std::size_t>(count.rend() - last);
  begin_.assign(1, 0);
  for (std::size_t c = 0; c < colors; ++c) begin_.push_back(begin_.back() + count[c]);
}

}  // namespace epafi
