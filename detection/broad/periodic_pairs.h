/// @file periodic_pairs.h  Images of bodies in a periodic cell, behind the bodies of a list, and the pairs they stand
/// for. A pair (i, image j + s) is also (j, image i - s): of free bodies images along one half of all directions are
/// enough. Images are held bodies to the list, so that no two of them pair; of bodies that are held themselves all
/// directions are needed. Only bodies whose fat box comes over a face into the region of the others have images.
#pragma once
#include <vector>

#include "engine/state/contacts.h"
#include "engine/state/periodic_cell.h"

namespace epafi {

struct CellImage {
  Slot of;
  std::int8_t x, y, z;  ///< -1, 0, 1: cells from the body
  Wraps step() const { return {x, y, z}; }
};

/// Puts the bodies' own slots and the image codes (as Pair::image) into pairs in which slots from `bodies` on are
/// images. Sorted by bodies and key.
void name_images(const World& world, const std::vector<CellImage>& images, const PairColumn& found, PairColumn& pairs);

}  // namespace epafi
