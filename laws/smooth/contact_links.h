/// @file contact_links.h  Present stiffness and damping of smooth contacts, for engine/step/stiffest_mode.h.
/// Both are those of the law at the present overlap; of a law with memory those of unloading, which is stiffer.
/// Friction counts as sticking, since a contact at its limit may stick in the next
/// step.
#pragma once
#include "engine/state/contacts.h"
#include "engine/step/stiffest_mode.h"
#include "laws/smooth/asked_law.h"
#include "laws/smooth/make_smooth_contact.h"

namespace epafi {

/// Slopes of the normal force of one contact.
struct NormalSlopes {
  double stiffness = 0.0;  ///< dN/d(delta) [N/m], >= 0
  double dashpot = 0.0;    ///< dN/d(delta_dot) [N s/m], >= 0
  double of_law = 0.0;     ///< k_n for friction and rolling [N/m]
  double force = 0.0;      ///< N at rest [N]
};

class ContactLinks {
 public:
  /// The set-up must pass check_smooth.
  explicit ContactLinks(const SmoothSetup& setup);
  /// Appends links of contacts [begin, end) that overlap, for a step of dt [s]. Separated contacts that a law with
  /// adhesion may hold count as held, since only the contact model knows whether they have touched.
  void append(const World& world, const ContactSet& contacts, std::size_t begin, std::size_t end, double dt,
              std::vector<StiffLink>& links) const;
  /// A link between bodies of materials i and j by overlap, radius, mass and area of `at`; mobilities: of slip, 1/m +
  /// r^2/I of both [1/kg], and of rolling [1/(kg m^2)], 0 where it does not count.
  StiffLink link(std::uint16_t i, std::uint16_t j, const ContactKinematics& at, double slip_mobility,
                 double rolling_mobility, double dt) const;
  NormalSlopes normal(std::uint16_t i, std::uint16_t j, const ContactKinematics& at) const;

 private:
  SmoothLaw law_;
  std::vector<AskedLaw> normal_;                                     ///< by pair
  double (*reach_)(const double* numbers, double radius) = nullptr;  ///< beyond touch [m]
};

}  // namespace epafi
