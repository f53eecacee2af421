/// @file rows.h  Plain rows one behind the other, as plans carry them; those of contacts and of places.
#pragma once
#include <cstring>
#include <vector>

#include "engine/state/contacts.h"
#include "ranks/row_bytes.h"

namespace epafi {

template <class Row>
void append_row(RowBytes& rows, const Row& row) {
  rows.resize(rows.size() + sizeof row);
  std::memcpy(rows.data() + rows.size() - sizeof row, &row, sizeof row);
}

template <class Row>
Row row_at(const RowBytes& rows, std::size_t k) {
  Row row;
  std::memcpy(&row, rows.data() + k * sizeof row, sizeof row);
  return row;
}

struct ContactRow {
  std::uint32_t a, b;  ///< ids
  std::uint64_t own;   ///< 1: the contact model keeps it by itself
  Feature feature;
  double gap, radius, area;
  double normal[3], arm[3], force[3], moment[3];
};
ContactRow row_of(const ContactSet& contacts, std::size_t k, const World& world, bool own);
void put_row(ContactSet& contacts, std::size_t k, const ContactRow& row, const World& world);

struct PlaceRow {
  std::uint32_t id;
  std::int32_t wraps[3];
  double position[3], turn[4];
};
PlaceRow place_of(const World& world, Slot s);
void put_place(const PlaceRow& row, World& world);

/// True if this rank sends contact k: as its owner; rank 0 for two bodies that every rank has.
bool tells_of(const World& world, Slot a, Slot b);

}  // namespace epafi
