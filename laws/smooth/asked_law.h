/// @file asked_law.h  A normal law by its name, asked for one contact at a time: for estimates beside the run.
#pragma once
#include "laws/smooth/smooth_law.h"

namespace epafi {

struct AskedLaw {
  std::vector<double> numbers;  ///< of the pair
  NormalEvaluation evaluation;
  bool is_hertzian = false, remembers = false;

  /// before, now: what the law remembers of the contact, 0 of a new one; nothing where it does not remember.
  NormalResponse respond(const ContactKinematics& at, double before, double& now) const {
    return evaluation.one(numbers.data(), at, &before, &now, nullptr);
  }
  /// Response of a new contact.
  NormalResponse first(const ContactKinematics& at) const {
    double now = 0.0;
    return respond(at, 0.0, now);
  }
};

/// `restitution` sets the damper of that normal law; where not, the law asks for a parameter of its own.
bool asks_for_restitution(const std::string& normal);

/// Of a pair of materials that occurs; normal: a name of all_normal_laws().
AskedLaw asked_law(const std::string& normal, const MaterialPair& pair);

}  // namespace epafi
