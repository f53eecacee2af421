#include "detection/narrow/pair_table.h"

namespace epafi {

const PairTable& pair_table() {
  static constexpr PairTable table = pair_table_detail::make_table(AllShapes{});
  return table;
}

std::string describe_pair_table() {
  std::string out;
  const auto entries = shape_entries(AllShapes{});
  for (std::size_t a = 0; a < entries.size(); ++a) {
    for (std::size_t b = 0; b < entries.size(); ++b) out += entries[a].name + " " + entries[b].name + " " + pair_table()[a][b].method + "\n";
  }
  return out;
}

}  // namespace epafi
