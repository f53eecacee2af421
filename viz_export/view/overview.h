/// @file overview.h  What is found by looking over a whole run once: the box that matters, the ranges of the fields,
/// and the frames worth showing.
#pragma once
#include <array>
#include <map>
#include <optional>
#include <set>

#include "viz_export/view/camera.h"
#include "viz_export/view/fields.h"

namespace epafi {

struct Overview {
  ViewBox box;  ///< region of the picture, without strays and distant walls
  /// Colour range of each numeric field. Both ends are equal for a single value; a field without values (no free
  /// bodies) is absent.
  std::map<std::string, std::array<double, 2>> range;
  std::set<std::string> resting;  ///< fields of which 98 % are no more than rounding gives
  /// Smallest and largest value of each field, including bodies outside the picture.
  std::map<std::string, std::array<double, 2>> extremes;
  float strongest = 0;                 ///< normal force of a contact [N], of 99 % of them; of few the largest
  float strongest_of_all = 0;          ///< [N]
  double worst_residual = 0;           ///< of a contact
  std::vector<std::uint32_t> grounds;  ///< ids of walls below all else, ascending (grounds.h)
  double ground_top = 0;               ///< the highest of them, along what is up [m]
  std::size_t frames_looked_at = 0;
};

/// Looks at 24 frames at most.
[[nodiscard]] Overview look_over(const ViewSource& source);

/// Start, end, and between them what shares the change of the run (distance that bodies move from frame to frame, their
/// size where they come or go) into equal parts: `wanted` frames at most, ascending, all different.
[[nodiscard]] std::vector<std::size_t> telling_frames(const ViewSource& source, std::size_t wanted);

/// Lower and upper end of the colours: by [view] range where it speaks of this field; none where it has no value.
[[nodiscard]] std::optional<std::array<double, 2>> colour_range(const Overview& overview, const ViewSettings& settings,
                                                                const std::string& field);

/// The field has one colour, whatever its range: 98 % are no more than rounding gives, and the scene asks for no range.
[[nodiscard]] bool is_resting(const Overview& overview, const ViewSettings& settings, const std::string& field);

}  // namespace epafi
