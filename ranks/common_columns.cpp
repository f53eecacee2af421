#include "ranks/common_columns.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "ranks/communicator.h"

namespace epafi {

namespace {
bool has_rows(const ImageColumn& c) {
  return c.whose != RowsOf::nobody && c.whose != RowsOf::ids && c.whose != RowsOf::share;
}
}  // namespace

void take_common(StateImage& image) {
  std::vector<std::uint64_t> sizes;
  for (const ImageColumn& c : image)
    if (!has_rows(c)) sizes.push_back(c.data.size());
  broadcast(sizes.data(), sizes.size() * sizeof sizes[0]);
  RowBytes all;
  for (const ImageColumn& c : image)
    if (!has_rows(c) && rank_number() == 0) all.insert(all.end(), c.data.begin(), c.data.end());
  all.resize(std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0}));
  broadcast(all.data(), all.size());
  auto from = all.begin();
  auto size = sizes.begin();
  for (ImageColumn& c : image) {
    if (has_rows(c)) continue;
    const auto end = from + static_cast<std::ptrdiff_t>(*size++);
    c.data.assign(from, end);
    from = end;
    if (c.whose == RowsOf::share && c.row == sizeof(double) && rank_number() != 0)
      std::fill(c.data.begin(), c.data.end(), std::byte{});
  }
}

void sum_shares(StateImage& image) {
  std::vector<double> sums;
  for (const ImageColumn& c : image) {
    if (c.whose != RowsOf::share) continue;
    sums.push_back(c.data[0] == std::byte{} ? 0.0 : 1.0);
    if (c.row == sizeof(double)) std::memcpy(&sums.back(), c.data.data(), sizeof(double));
  }
  sum_over_ranks(sums);
  auto sum = sums.begin();
  for (ImageColumn& c : image) {
    if (c.whose != RowsOf::share) continue;
    if (c.row == sizeof(double))
      std::memcpy(c.data.data(), &*sum, sizeof(double));
    else
      c.data[0] = std::byte{*sum != 0.0};
    ++sum;
  }
}

void drop_rows(StateImage& image) {
  for (ImageColumn& c : image)
    if (has_rows(c)) c.data.clear();
}

void forget_slots(Simulation& sim) {
  const Reordering gone{std::vector<Slot>(sim.world.size(), no_slot)};
  sim.pipeline.broad_phase->reorder(gone);
  sim.pipeline.narrow_phase->reorder(gone);
  sim.work.contacts.clear();
}

}  // namespace epafi
