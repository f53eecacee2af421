/// @file plausible.h  Plausibility of the points of a wheel or rail profile: side of the flange, sign of z, whether the
/// gauge can be measured, units, columns, noise. A reversed profile still has contacts, so its results would look
/// normal.
#pragma once
#include <string>
#include <vector>

#include "detection/profiles/profile.h"

namespace epafi {

/// Texts for people, without the name of the profile.
struct ProfileRemarks {
  std::string problem;              ///< not empty: no profile of a wheel (or rail) in these conventions
  std::vector<std::string> doubts;  ///< possible, but results may be wrong
};

/// y from the tape circle, flange side negative, z the increase of radius [m].
ProfileRemarks remarks_on_wheel(const ProfilePoints& points);
/// y from the rail's axis, gauge side positive, z downwards [m].
ProfileRemarks remarks_on_rail(const ProfilePoints& points);

/// Standard deviation of the points' noise [m]: from fourth differences, whose median is that of the noise where the
/// profile is smooth over five points.
double noise_of(const ProfilePoints& points);
/// Effect of noise on the curvature of a spline with this `smoothing` [m], and the smoothing that removes it; empty if
/// small.
std::string noise_remark(const ProfilePoints& points, double smoothing);
/// An outlier that would bend a spline through it; empty if there is none.
std::string outlier_remark(const ProfilePoints& points);
/// The widest hole between points inside the profile; empty if there is none.
std::string hole_remark(const ProfilePoints& points);
/// A smoothing beyond the scatter of the points; else empty.
std::string smoothing_remark(const ProfilePoints& points, double smoothing);
/// Points that are narrow beside the wheel's radius or the gauge [m] as none are; empty else.
std::string scale_remark(double width, double beside, double least_share);

}  // namespace epafi
