/// @file colours.h  Colours of numbers and of kinds, readable for the colour-blind and in grey; the page has the same
/// (page/colours.js).
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

namespace epafi {

using Rgb = std::array<double, 3>;  ///< red, green, blue in [0, 1]

/// Behind everything, and of letters on it.
inline constexpr Rgb paper{0.969, 0.973, 0.980}, ink{0.11, 0.14, 0.19};

/// A polynomial of sixth degree in the share.
inline Rgb polynomial_colour(const Rgb (&c)[7], double share) {
  const double t = std::clamp(share, 0.0, 1.0);
  Rgb out{};
  for (std::size_t k = 0; k < 3; ++k) {
    double value = 0;
    for (std::size_t power = 7; power-- > 0;) value = value * t + c[power][k];
    out[k] = std::clamp(value, 0.0, 1.0);
  }
  return out;
}

/// Viridis (van der Walt and Smith 2015), coefficients after Zucker 2019; error < 0.01.
inline Rgb viridis(double share) {
  constexpr Rgb c[7] = {{0.2777273272234177, 0.005407344544966578, 0.3340998053353061},
                        {0.1050930431085774, 1.404613529898575, 1.384590162594685},
                        {-0.3308618287255563, 0.214847559468213, 0.09509516302823659},
                        {-4.634230498983486, -5.799100973351585, -19.33244095627987},
                        {6.228269936347081, 14.17993336680509, 56.69055260068105},
                        {4.776384997670288, -13.74514537774601, -65.35303263337234},
                        {-5.435455855934631, 4.645852612178535, 26.3124352495832}};
  return polynomial_colour(c, share);
}

/// Inferno, of the same authors: for contacts.
inline Rgb inferno(double share) {
  constexpr Rgb c[7] = {{0.0002189403691192265, 0.001651004631001012, -0.01948089843709184},
                        {0.1065134194856116, 0.5639564367884091, 3.932712388889277},
                        {11.60249308247187, -3.972853965665698, -15.9423941062914},
                        {-41.70399613139459, 17.43639888205313, 44.35414519872813},
                        {77.162935699427, -33.40235894210092, -81.80730925738993},
                        {-71.31942824499214, 32.62606426397723, 73.20951985803202},
                        {25.13112622477341, -12.24266895238567, -23.07032500287172}};
  return polynomial_colour(c, share);
}

/// Position in a colour map where all values are equal.
inline constexpr double only_share = 0.5;

inline constexpr std::size_t kinds_apart = 12;  ///< further kinds repeat their colours

/// Eight colours that stay apart for all kinds of colour vision (Okabe and Ito 2008), without black; then four dark
/// ones.
inline Rgb kind_colour(std::size_t kind) {
  constexpr Rgb all[kinds_apart] = {{0.00, 0.45, 0.70}, {0.90, 0.62, 0.00}, {0.00, 0.62, 0.45}, {0.80, 0.47, 0.65},
                                    {0.34, 0.71, 0.91}, {0.84, 0.37, 0.00}, {0.94, 0.89, 0.26}, {0.60, 0.60, 0.60},
                                    {0.00, 0.18, 0.38}, {0.45, 0.31, 0.00}, {0.00, 0.35, 0.15}, {0.42, 0.18, 0.36}};
  return all[kind % kinds_apart];
}

}  // namespace epafi
