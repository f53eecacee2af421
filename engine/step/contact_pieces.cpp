#include "engine/step/contact_pieces.h"

namespace epafi {

ContactSet ContactPieces::wanted(const ContactModel::Wanted& is_wanted) const {
  std::vector<ContactSet> found(size_);
  const auto take = [&](std::size_t piece) {
    ContactSet& room = found[piece];
    if (is_own(piece)) return model_->append_contacts(world_, piece - known_, is_wanted, room);
    const std::size_t end = std::min(contacts_.force.size(), (piece + 1) * sum_block);
    for (std::size_t k = piece * sum_block; k < end; ++k) {
      if (!is_wanted(contacts_.a[k], contacts_.b[k])) continue;
      room.append(contacts_.a[k], contacts_.b[k],
                  {contacts_.gap[k], contacts_.normal[k], contacts_.arm[k], 0.0, contacts_.feature[k]});
      room.force.push_back(contacts_.force[k]);
    }
  };
  parallel_for(size_, take, 1);
  ContactSet all;
  for (const ContactSet& room : found) {
    all.append(room);
    all.force.insert(all.force.end(), room.force.begin(), room.force.end());
  }
  all.sort();
  return all;
}

}  // namespace epafi
