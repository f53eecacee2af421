#include "detection/narrow/pairs/pair_table.h"

namespace epafi {

const PairTable& pair_table() {
  static constexpr PairTable table = pair_table_detail::make_table(AllShapes{});
  return table;
}

const char* pair_method(std::string_view a, std::string_view b) {
  const auto entries = shape_entries(AllShapes{});
  const auto place = [&](std::string_view name) {
    std::size_t k = 0;
    while (k < entries.size() && entries[k].name != name) ++k;
    return k;
  };
  const std::size_t i = place(a), j = place(b);
  return i < entries.size() && j < entries.size() ? pair_table()[i][j].method : "none";
}

std::string describe_pair_table() {
  std::string out;
  const auto entries = shape_entries(AllShapes{});
  for (std::size_t a = 0; a < entries.size(); ++a) {
    for (std::size_t b = 0; b < entries.size(); ++b)
      out += entries[a].name + " " + entries[b].name + " " + pair_table()[a][b].method + "\n";
  }
  return out;
}

}  // namespace epafi
