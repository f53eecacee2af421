/// @file picture.h  A snapshot as a vector picture: bodies with their true surfaces, far ones first, coloured by speed;
/// walls as pale outlines that do not hide what is in them. Orthographic; no library, no display.
#pragma once
#include <string>

#include "viz_export/stored_run.h"

namespace epafi {

struct PictureView {
  Vec3 from{-0.45, -1.0, 0.5};  ///< direction from which it is seen, any length; z points up in the picture
  double width = 640, height = 520;
  std::size_t most = 30000;  ///< of faces and spheres; the nearest are drawn
};

/// An <svg> element. fastest: speed that takes the end of the colour scale [m/s]; 0: that of the snapshot.
[[nodiscard]] std::string picture_svg(const StoredSnapshot& snapshot, const PictureView& view = {}, double fastest = 0.0);

}  // namespace epafi
