/// @file wheel_rail.h  Contact of a wheel (surface of revolution) on an extruded rail, in three dimensions with yaw:
/// all contact points, and the gap around them. Track axes: x forwards, y to the right, z down; the origin is the
/// middle of the track at the rails' top.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "detection/profiles/profile.h"
#include "engine/railway/contact_region.h"

namespace epafi {

/// Position of the wheelset.
struct WheelsetPosition {
  double lateral_shift = 0.0;  ///< to the right [m]
  double height = 0.0;  ///< of the axle's middle below that of a wheelset of the nominal radius on the rails' top [m]
  double yaw = 0.0;     ///< x towards y [rad]
  double roll = 0.0;    ///< y towards z [rad]
};

/// Fixed dimensions.
struct TrackGeometry {
  double radius = 0.46;         ///< of the wheel at the tape circle [m]
  double gauge = 1.435;         ///< between the rails' gauge faces [m]
  double gauge_height = 0.014;  ///< below the rail's top, where the gauge is measured [m]
  double flange_back = 1.36;    ///< between the wheels' inner faces [m]
  double tape_circle = 0.07;    ///< from the wheel's inner face [m]
};

class WheelRailPair final : public GapSource {
 public:
  /// right: side of the track. The left one is computed as mirror image; results are in track axes.
  WheelRailPair(const Profile& wheel, const Profile& rail, const TrackGeometry& track, bool right);
  void place(const WheelsetPosition& position);
  /// The same wheel and rail on the left or right, sharing the tables; call place() next.
  WheelRailPair on_side(bool right) const;

  /// Lowers or lifts the wheel until it just touches; gaps refer to this position, since on a steep flank a vertical
  /// motion also changes them sideways.
  void touch();
  /// The same, and finds the regions with gaps below `reach` [m], the deepest first, without profiles. Returns the
  /// distance by which it was lowered [m].
  double touch(double reach, std::vector<ContactRegion>& regions);
  /// Lowers the wheel by `depth` [m] from first touch, to its position under load. Gaps still refer to first touch,
  /// along the normal of their plane. On a flank this vertical motion closes gaps beside the plane's origin more than a
  /// motion along the normal (S1002 on UIC60 at 5 mm: 1 um of the 6 um of the second region).
  void lower(double depth);
  /// Sampling of the gap around a region across the track.
  struct Sampling {
    double step = 0.2e-3, reach = 16e-3;  ///< between lines; to both sides of the region [m]
    double until = 1.0;                   ///< the gap is constant beyond this value [m]
  };
  void sample_profiles(const Sampling& sampling) { sampling_ = sampling; }
  /// Fills region.profile, for a region in track axes.
  void add_profile(ContactRegion& region) const;
  /// Removes other regions from a region's profile: beyond the highest gap between them it only opens.
  void part(ContactRegion& region, const ContactRegion& other) const;
  /// Regions with gaps below `reach` [m] when the deepest touches, the deepest first.
  std::vector<ContactRegion> regions() const override { return find_regions(2e-4); }
  std::vector<ContactRegion> find_regions(double reach) const;
  /// The region that touches first, without its profile; none if there is no contact.
  std::optional<ContactRegion> deepest() const;
  /// Smallest vertical gap: distance by which the wheel can be lowered before it touches [m]; infinite if wheel and
  /// rail do not overlap laterally.
  double clearance() const;
  /// Reason why there is no contact: the smallest gap must lie inside both profiles.
  enum class Missing { nothing, apart, wheel_ends, rail_ends };
  Missing missing() const;
  bool has_gauge_face() const;  ///< a point of the rail lies as deep as the gauge is measured
  GapField field(const ContactRegion& region, double x, double y, double dx, double dy, std::size_t nx,
                 std::size_t ny) const override;
  ContactRegion moved(const ContactRegion& region, double y, double angle) const override;
  /// The same without the profile of the gap.
  ContactRegion place_at(const ContactRegion& region, double y, double angle) const;
  double angle_at(const ContactRegion& region, double y) const override;
  std::unique_ptr<GapOperator> gaps_between(GapMethod method, std::span<const Vec3> nodes,
                                            std::span<const std::array<std::uint32_t, 3>> first,
                                            std::span<const std::array<std::uint32_t, 3>> second,
                                            double band) const override;

  const TrackGeometry& track() const { return track_; }
  double rail_axis() const { return axis_; }  ///< distance of the rail's axis from the middle of the track [m]

 private:
  /// A point of the wheel where it is lowest along x for its lateral place, in the frame of the right side.
  struct Locus {
    Vec3 point;
    double gap;    ///< vertical, to the rail below [m]
    double slope;  ///< of that over y_wheel
  };
  Locus locus(double y_wheel) const;
  double refine(double y_wheel) const;
  void make_tables();
  /// Gaps at the scan's places from the tables, first place in `from` [m]; 0.03 um off at a curvature of 100 /m.
  std::vector<double> scan(double& from) const;
  ContactRegion region_at(double y_wheel, double deepest) const;
  std::vector<std::pair<double, double>> minima(double reach) const;
  std::vector<ContactRegion> regions_at(const std::vector<std::pair<double, double>>& minima, double reach) const;
  /// Tangent plane of a region in the frame of the right side.
  struct Plane {
    Vec3 origin, t, n;
  };
  Plane plane_of(const ContactRegion& region) const;
  /// Heights over the plane; NaN where a surface stands steeper than 80 degrees on it or is not met.
  double rail_height(const Plane& plane, double s, double guess) const;
  double wheel_height(const Plane& plane, double x, double s, double guess) const;
  struct Sample {
    double rail, wheel, x;
  };
  /// One place of a profile from a guess of it; false where a surface is not met.
  bool sample(const Plane& plane, std::size_t k, Sample& here, GapProfile& profile) const;

  const Profile& wheel_;
  const Profile& rail_;
  TrackGeometry track_;
  double mirror_ = 1.0;  ///< 1 right, -1 left
  double axis_ = 0.0, tape_ = 0.0;
  Vec3 centre_ = Vec3::Zero();
  Mat3 turn_ = Mat3::Identity();  ///< axle axes to track axes of this side
  double tan_yaw_ = 0.0;          ///< of that turn
  double depth_ = 0.0;            ///< lowered from touching [m]
  double scan_from_ = 0.0, scan_to_ = 0.0;
  struct Tables {
    struct WheelPlace {
      double radius, slope;
    };
    std::vector<WheelPlace> wheel;  ///< from the wheel's first point in steps of the scan
    std::vector<double> rail;       ///< heights, finely from the rail's first point
  };
  std::shared_ptr<const Tables> tables_;  ///< of the profiles: the same on both sides of the track
  Sampling sampling_;
};

/// Rigid geometry of a whole wheelset standing on both rails.
struct WheelsetGeometry {
  WheelsetPosition position;  ///< roll and height found
  ContactRegion left, right;  ///< deepest regions
  bool stands = true;         ///< false where no such place was found: there is no contact on one of the rails
  double rolling_radius_difference() const { return right.rolling_radius - left.rolling_radius; }
};
/// Finds height and roll of a wheelset on both rails; lateral_shift is that of the axle's middle. On a flange steeper
/// than (distance of the contacts) / radius, climbing reduces the shift of the axle, so larger shifts have no solution
/// until the flange's tip is on the rail.
WheelsetGeometry stand_on_rails(const Profile& wheel, const Profile& rail, const TrackGeometry& track,
                                WheelsetPosition start);

/// The same for the wheelset of which this is one side.
WheelsetGeometry stand_on_rails(const WheelRailPair& side, WheelsetPosition start);

/// The same with the shift counted at the rails' height, where rolling about the axle's middle moves the wheels by
/// roll times radius: one place for every shift. position.lateral_shift is then the axle's.
WheelsetGeometry stand_at_rails(const WheelRailPair& side, WheelsetPosition start);

/// Equivalent conicity at this amplitude [m]: wavelength of the wheelset's free kinematic motion
/// y'' = -delta_r(y) / (r0 s), integrated over a whole period (EN 15302, annex B), put into Klingel's formula. NaN if
/// the wheelset has no contact at this amplitude. Displacements count at the rails. Roll of the wheelset, which the
/// standard's tables neglect, adds 0.002 to 0.007 (wheel B on rail A).
double equivalent_conicity(const Profile& wheel, const Profile& rail, const TrackGeometry& track, double amplitude);
/// The same from rolling radius differences [m] at an odd number of equal steps over [-amplitude, amplitude].
double conicity_of(const std::vector<double>& difference, double amplitude, const TrackGeometry& track);

}  // namespace epafi
