/// @file track.h  Two rails of one profile along a line: straight, then a clothoid into a curve with superelevation,
/// each rail off its place by measured or sinusoidal irregularities. Axes of the track: x forwards, y to the right, z
/// down, origin in the middle at the rails' top where the distance along the line is 0.
#pragma once
#include <string>
#include <vector>

#include "detection/profiles/profile.h"
#include "detection/profiles/wheel_rail.h"
#include "engine/railway/guideway.h"

namespace epafi {

/// A curve to the right (radius > 0) or left: curvature and superelevation grow linearly over the transition.
struct TrackCurve {
  double radius = 0.0;          ///< [m]; 0: straight
  double start = 0.0;           ///< distance where the transition begins [m]
  double transition = 0.0;      ///< its length [m], >= 0
  double superelevation = 0.0;  ///< of the outer rail over the inner one [m], >= 0
};

/// Displacement of one rail from its place [m]; y to the right, z down.
struct RailShift {
  double y = 0.0, z = 0.0;
};

/// Samples of both rails' shifts at increasing distances, joined by lines; before and after them those of the ends.
struct MeasuredTrack {
  std::vector<double> distance, lateral, vertical, cross_level, gauge;  ///< [m]
};
/// Both rails follow a sin(2 pi s / wavelength).
struct SinusoidalTrack {
  double lateral = 0.0, vertical = 0.0, cross_level = 0.0;  ///< amplitudes [m]
  double wavelength = 1.0;                                  ///< [m], > 0
};

class Track final : public Guideway {
 public:
  Track() = default;
  Track(Profile rail, TrackGeometry geometry, TrackCurve curve = {})
      : rail(std::move(rail)), geometry(geometry), curve(curve) {}
  Profile rail;
  TrackGeometry geometry;  ///< gauge and where it is measured
  TrackCurve curve;
  SinusoidalTrack wave;
  MeasuredTrack measured;

  /// In the track's own axes.
  Pose frame(double s) const override;
  double distance_of(const Vec3& point) const override;
  double curvature(double s) const;  ///< [1/m], > 0 to the right
  double heading(double s) const;    ///< [rad], x towards y
  /// Shift of the left or right rail at distance s [m].
  RailShift shift(double s, bool right) const;
  /// Direction of that rail in the axes of frame(s), of length 1; `beside`: of the rail's axis from the middle [m].
  Vec3 direction(double s, bool right, double beside) const;

 private:
  double share(double s) const;  ///< of the full curvature, in [0, 1]
};

/// Either the samples or what is wrong, with the line: CSV with the header `s,lateral,vertical[,cross_level][,gauge]`
/// [m] under a first line `# unit: m` (or mm, for all columns but s).
struct MeasuredFile {
  MeasuredTrack track;
  std::string problem;
  int line = 0;
};
MeasuredFile read_irregularity(const std::string& text);

}  // namespace epafi
