/// @file patch_contact.h  The geometry of a patch case, found once, and its normal contact by any model.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "laws/wheel_rail/tangential/beside_plane.h"
#include "scenes/patch/patch_case.h"
#include "scenes/patch/seated_wheel.h"

namespace epafi {

const NormalModel& normal_model(const std::string& name);
/// Seconds a solution, 1 % off.
inline bool is_finite_elements(const std::string& model) { return model.starts_with("fem"); }

/// A line contact and a given ellipse are Hertz whatever the name of the model.
class PatchContactSolver {
 public:
  explicit PatchContactSolver(const PatchCase& patch, bool keep_stresses = false);

  /// Patches of a model under this force along the normal, or approach, of the deepest region.
  std::vector<RegionPatch> solve(const std::string& model, const NormalTarget& target);
  /// Patches of all regions with the wheel as deep as it is seated: for models of the whole gap.
  std::vector<RegionPatch> solve_apart(const std::string& model);

  /// Brings the wheel `down` from where it touches [m].
  void seat(double down) { wheel_->seat(down); }
  /// Seats the wheel anew at this approach of the deepest region.
  void follow(double expected);
  /// True where the wheel's position agrees with a model's approach; only models of the whole gap give one.
  bool stands(const std::string& model, double found) const;
  bool has_wheel() const { return wheel_ && !wheel_->rigid.empty() && !too_shallow(); }
  /// Several regions far from each other overlap under the load, and the model solves each.
  bool apart(const std::string& model) const { return has_wheel() && wheel_->apart() && normal_model(model).whole_gap; }
  /// Positions of its patches, where creepages are evaluated.
  const std::vector<ContactRegion>& places(const std::string& model) const;
  /// Creepage at the middle of a patch: as given, or of the rigid wheelset rolling with its speed over its angular
  /// velocity.
  Creepage creepage(const ContactRegion& region) const;
  /// Difference between the longitudinal slip of the surface itself and that of its plane, row by row: a rail's head
  /// leaves the plane between two hills of pressure by tenths of a millimetre, and the wheel's radius with it. Empty
  /// where the creepage is given.
  SlipBesidePlane slip_beside_plane(const ContactRegion& region, const NormalPatch& patch) const;
  double depth() const { return wheel_->depth; }      ///< estimated displacement of the wheel by the load [m]
  double lowered() const { return wheel_->lowered; }  ///< present displacement of the wheel [m]
  /// Processor time [s] of the geometry, and since begin_pair() that of reused solutions.
  double seconds() const { return seconds_ + remembered_seconds_; }
  void begin_pair() { remembered_seconds_ = 0.0; }

  bool rough = false;                ///< strips need not settle yet: the wheel will be seated anew
  std::vector<std::string> reasons;  ///< why no result of this case is valid

 private:
  /// A solution by finite elements, which take seconds: tangential models mostly ask for the same ones.
  struct Known {
    std::string model;
    double target, lowered, approach;
    std::vector<RegionPatch> patches;
    double seconds;
  };
  std::vector<RegionPatch> remembered(const NormalModel& model, const NormalTarget& target);
  bool too_shallow() const;
  void place_wheel(const ProfileCase& p);
  double loaded_radius(const ProfileCase& p, const WheelsetPosition& position);
  NormalInput input(const NormalModel& model, const NormalTarget& target);
  RegionPatch line(const std::string& model, const NormalTarget& target) const;
  RegionPatch none() const;

  const PatchCase& c_;
  std::unique_ptr<GapSource> quadratic_;
  std::optional<SeatedWheel> wheel_;
  std::vector<ContactRegion> regions_;  ///< of the quadratic gap
  std::vector<StripStart> strips_ = std::vector<StripStart>(1);
  double mean_radius_ = 0.0;  ///< speed over angular velocity of the wheelset [m]
  double seconds_ = 0.0;
  std::vector<Known> known_;
  double remembered_seconds_ = 0.0;
  std::string missing_;    ///< why there is no contact
  bool stresses_ = false;  ///< finite elements keep those inside the body
};

}  // namespace epafi
