/// @file asked_law.h  A normal law by its name, asked for one contact at a time: for estimates beside the run, which
/// are then compiled once and not for each law.
#pragma once
#include <functional>

#include "laws/contact_law.h"

namespace epafi {

struct AskedLaw {
  /// before, now: what the law remembers of the contact, 0 of a new one; nothing where it does not remember.
  std::function<NormalResponse(const ContactKinematics& at, double before, double& now)> respond;
  bool is_hertzian = false, remembers = false;

  /// Of a new contact.
  NormalResponse first(const ContactKinematics& at) const {
    double now = 0.0;
    return respond(at, 0.0, now);
  }
};

/// Of a pair of materials that occurs; normal: a name of all_normal_laws().
AskedLaw asked_law(const std::string& normal, const MaterialPair& pair);

}  // namespace epafi
