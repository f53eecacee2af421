#include "viz_export/vtk/contact_list.h"

namespace epafi {

std::vector<std::uint32_t> ContactList::acting(const ContactSet& contacts, std::size_t begin, std::size_t end,
                                               bool all) {
  std::vector<std::uint32_t> places;
  if (contacts.force.size() != contacts.size()) return places;
  places.reserve(end - begin);
  for (std::size_t i = begin; i < end; ++i)
    if (all || contacts.gap[i] < 0.0 || contacts.force[i].squaredNorm() != 0.0)
      places.push_back(static_cast<std::uint32_t>(i));
  return places;
}

ContactList::ContactList(const World& world, const ContactPieces& contacts, std::span<const float> residual)
    : world_(&world), contacts_(contacts), residual_(residual) {
  std::vector<std::size_t> rows(contacts.size());
  parallel_for(
      rows.size(),
      [&](std::size_t piece) {
        if (const auto count = contacts.all_touching(piece))
          rows[piece] = *count;
        else
          contacts.read(piece, [&](const ContactSet& c, std::size_t begin, std::size_t end) {
            rows[piece] = acting(c, begin, end, false).size();
          });
      },
      16);
  begins_ = {0};
  for (std::size_t piece = 0; piece < rows.size(); ++piece)
    if (rows[piece] > 0) {
      pieces_.push_back(piece);
      begins_.push_back(begins_.back() + rows[piece]);
    }
  if (pieces_.empty()) begins_.push_back(0);
}

ContactList::ContactList(const World& world, const ContactSet& contacts, std::span<const float> residual)
    : world_(&world), contacts_(ContactPieces(world, contacts)), residual_(residual), all_act_(true), begins_{0} {
  for (std::size_t piece = 0; piece < contacts_->size(); ++piece) {
    pieces_.push_back(piece);
    begins_.push_back(std::min(contacts.size(), (piece + 1) * sum_block));
  }
  if (pieces_.empty()) begins_.push_back(0);
}

void ContactList::copy(ContactSet& contacts, std::vector<float>& residual) const {
  contacts.renew(size());
  bool has_residual = false;
  if (!residual_.empty()) read(0, [&](const ContactRows& rows) { has_residual = rows.has_residual(); });
  residual.resize(has_residual ? size() : 0);
  parallel_for(
      pieces_.size(),
      [&](std::size_t piece) { read(piece, [&](const ContactRows& rows) { rows.copy(contacts, residual); }); }, 16);
}

void ContactRows::copy(ContactSet& contacts, std::vector<float>& residual) const {
  for (std::size_t row = begin(); row < end(); ++row) {
    contacts.put(row, *contacts_, at(row));
    if (has_residual()) residual[row] = this->residual(row);
  }
}

Vec3 ContactRows::from(std::size_t row) const {
  const std::size_t i = at(row);
  const Slot a = contacts_->a[i];
  return world_->is_movable(a) ? world_->shown_position(a) : contacts_->point(i, *world_);
}

Vec3 ContactRows::to(std::size_t row) const {
  const std::size_t i = at(row);
  const Slot a = contacts_->a[i], b = contacts_->b[i];
  const Vec3 moved = world_->shown_position(a) - world_->position[a];  // as `from` is
  if (!world_->is_movable(b)) return contacts_->point(i, *world_) + moved;
  return world_->position[a] + moved + world_->branch(a, b, contacts_->feature[i]);
}

}  // namespace epafi
