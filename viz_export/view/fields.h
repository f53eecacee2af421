/// @file fields.h  What bodies can be coloured by: values of one frame, per body, with units.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "viz_export/view/view_source.h"

namespace epafi {

struct ViewField {
  enum class Kind {
    moving,   ///< a number per body and frame: stored
    fixed,    ///< a number per body: follows from the table of bodies or from the position
    category  ///< a kind per body
  };
  std::string name;   ///< "speed"
  std::string label;  ///< "speed"; for people
  std::string unit;   ///< SI, "" for none
  Kind kind = Kind::moving;
};

/// Those that the source can give, "speed" first.
[[nodiscard]] std::vector<ViewField> view_fields(const ViewSource& source);

/// Of all fields, whether a source has them or not.
[[nodiscard]] std::vector<std::string> view_field_names();

/// One value per body of the frame. Volumes of bodies with surfaces are those of the surfaces.
[[nodiscard]] std::vector<float> field_values(const std::string& field, const ViewFrame& frame, const RunAbout& about);

/// Index of the group of a body; the number of groups where it has none.
[[nodiscard]] std::size_t group_of(const RunAbout& about, std::uint32_t id);

}  // namespace epafi
