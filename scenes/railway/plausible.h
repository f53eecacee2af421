/// @file plausible.h  What speaks against the points of a wheel or rail profile: on which side the flange is, which way
/// z points, whether the gauge can be measured, units, columns, noise. A profile taken the wrong way round still
/// touches somewhere, and the answer looks like any other.
#pragma once
#include <string>
#include <vector>

#include "detection/profiles/profile.h"

namespace epafi {

/// Texts for people, without the name of the profile.
struct ProfileRemarks {
  std::string problem;              ///< not empty: this is no profile of a wheel (of a rail) as they are counted here
  std::vector<std::string> doubts;  ///< it may be meant so, but what is computed from it need not be right
};

/// y from the tape circle, flange side negative, z the increase of radius [m].
ProfileRemarks remarks_on_wheel(const ProfilePoints& points);
/// y from the rail's axis, gauge side positive, z downwards [m].
ProfileRemarks remarks_on_rail(const ProfilePoints& points);

/// Standard deviation of the points' noise [m]: from fourth differences, whose median is that of the noise where the
/// profile is smooth over five points.
double noise_of(const ProfilePoints& points);
/// What noise does to the curvature of a spline of this `smoothing` [m], and the smoothing that mends it; empty where
/// it is little.
std::string noise_remark(const ProfilePoints& points, double smoothing);
/// One point off its neighbours as no profile is, which bends a spline through it; empty where there is none.
std::string outlier_remark(const ProfilePoints& points);
/// A smoothing that takes away more than the points scatter; empty where it does not.
std::string smoothing_remark(const ProfilePoints& points, double smoothing);
/// Points that are narrow beside the wheel's radius or the gauge [m] as none are; empty else.
std::string scale_remark(double width, double beside, double least_share);

}  // namespace epafi
