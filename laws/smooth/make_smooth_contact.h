/// @file make_smooth_contact.h  From the names a scene gives to the contact model with exactly these parts.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "engine/step/pipeline.h"
#include "engine/units/error.h"
#include "laws/material.h"

namespace epafi {

/// Smooth contact as set in a scene. Empty names take the default of the law; friction 0 everywhere takes no tangential
/// part and rolling friction 0 everywhere no rolling part, whatever the names.
struct SmoothSetup {
  std::string law;         ///< of all_smooth_laws()
  std::string tangential;  ///< of all_tangential_laws(), or empty
  std::string rolling;     ///< of all_rolling_laws(), or empty
  MaterialTable materials;
  bool locate = false;  ///< start and end of contacts are located within the step
};

/// Names of the parts a set-up comes to.
struct SmoothParts {
  std::string normal, tangential, rolling;
  bool locate = false;
};

/// The laws by the names scenes use; fields are those of the normal part and of its default companions.
const std::vector<Entry>& all_smooth_laws();
std::vector<Entry> all_normal_laws();
std::vector<Entry> all_tangential_laws();
std::vector<Entry> all_rolling_laws();

SmoothParts smooth_parts(const SmoothSetup& setup);
/// Errors (unknown names, impossible combinations, constants a material lacks) and warnings; empty when all is well.
std::vector<Problem> check_smooth(const SmoothSetup& setup);
/// Union of the needs of the parts. The set-up must have passed check_smooth.
Needs smooth_needs(const SmoothSetup& setup);
/// Contacts with a gap below this are wanted [m]: an adhesive law holds on to bodies that have parted (with a tenth to
/// spare, so that a contact is seen to break before it is gone). largest_radius: R* of the largest bodies [m].
double smooth_reach(const SmoothSetup& setup, double largest_radius);
/// Throws SceneError with the errors of check_smooth.
std::unique_ptr<ContactModel> make_smooth_contact(const SmoothSetup& setup);

}  // namespace epafi
