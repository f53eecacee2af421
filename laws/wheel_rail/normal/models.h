/// @file models.h  The normal models, one file each; listed in normal_models.cpp.
#pragma once
#include "laws/wheel_rail/normal_models.h"

namespace epafi {

std::vector<RegionPatch> solve_hertz(const NormalInput& in);           ///< hertz.cpp
std::vector<RegionPatch> solve_multi_hertz(const NormalInput& in);     ///< multi_hertz.cpp
std::vector<RegionPatch> solve_kik_piotrowski(const NormalInput& in);  ///< kik_piotrowski.cpp
std::vector<RegionPatch> solve_stripes(const NormalInput& in);         ///< strips_by_hertz.cpp
std::vector<RegionPatch> solve_analyn(const NormalInput& in);
std::vector<RegionPatch> solve_semi_hertz(const NormalInput& in);  ///< semi_hertz.cpp
std::vector<RegionPatch> solve_fem(const NormalInput& in);         ///< fem.cpp: Lagrange multipliers at nodes
std::vector<RegionPatch> solve_fem_penalty(const NormalInput& in);
std::vector<RegionPatch> solve_fem_augmented(const NormalInput& in);
std::vector<RegionPatch> solve_fem_surface(
    const NormalInput& in);  ///< augmented Lagrangian, integrated over the surface
std::vector<RegionPatch> solve_half_space(const NormalInput& in);  ///< half_space_patch.cpp

/// Largest change of the gap against its osculating parabola over the patch, relative to the gap at the patch's edge:
/// about the error of Hertz' peak, measured against boundary elements on S1002/UIC60.
double distortion(const ContactRegion& region, double half_width);
/// Shift of the strip centres along the track over the width of a patch, relative to its length: 0.16 on the flange of
/// a yawed wheel, where strips and ellipses along the track are 1 to 3 % off in the peak.
double askew(const ContactRegion& region, double half_width, double half_length);
/// Adds a reason for surfaces that rotate over the patch: no half-spaces.
void check_conformal(const ContactRegion& region, const NormalPatch& patch, std::vector<std::string>& reasons);
/// Adds reasons why Hertz theory is out of its range: conformal surfaces, curvature that changes over the patch.
void check_hertz_range(const ContactRegion& region, const NormalPatch& patch, std::vector<std::string>& reasons);
/// For models of one patch: adds a reason where another region, farther than `beyond` [m], would touch at this
/// approach.
void check_second_region(const NormalInput& in, NormalPatch& patch, double beyond = 0.0);

}  // namespace epafi
