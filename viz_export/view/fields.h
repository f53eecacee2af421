/// @file fields.h  Fields for colours: values of one frame, per body, with units.
#pragma once
#include <array>
#include <optional>
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
  bool whole = false;  ///< a count or a number of something
};

/// Fields that the source has, "speed" first.
[[nodiscard]] std::vector<ViewField> view_fields(const ViewSource& source);

/// Names of all fields, whether or not a source has them.
[[nodiscard]] std::vector<std::string> view_field_names();

/// Sums over the contacts of a frame, per body.
struct ContactSums {
  std::vector<float> count, force, residual;  ///< number, sum of normal forces [N], Euclidean part of the residual
  /// Stress in the mean over the body, tension positive [Pa]: sum of arm times force over the volume (Love 1927). The
  /// arm leads along the centre line to the point that divides it by the bounding radii: exact for spheres. 0 in walls.
  std::vector<Mat3> stress;
};
[[nodiscard]] ContactSums contact_sums(const ViewFrame& frame);

/// The values of a frame, one per body; what its contacts give is summed up once. The frame must stay.
class FrameFields {
 public:
  FrameFields(const ViewFrame& frame, const RunAbout& about);
  /// Volumes of bodies with surfaces are those of the surfaces.
  std::vector<float> operator()(const std::string& field) const;

  /// Summed at the first call, which no two threads may make at once.
  const ContactSums& sums() const;

 private:
  const ViewFrame& frame_;
  const RunAbout& about_;
  Vec3 up_;
  mutable std::optional<ContactSums> sums_;
};

/// Index of the group of a body; the number of groups where it has none.
[[nodiscard]] std::size_t group_of(const RunAbout& about, std::uint32_t id);

}  // namespace epafi
