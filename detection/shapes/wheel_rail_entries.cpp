// Keys of the two shapes of a railway, in scenes and in cases of `epafi patch` alike.
#include "detection/profiles/wheelset.h"
#include "detection/shapes/rail_profile.h"
#include "detection/shapes/wheel_profile.h"

namespace epafi {
namespace {

Field number(const char* name, const char* symbol, const char* unit, Range range, const char* help) {
  return {name, symbol, unit, Kind::number, {}, range, help, true};
}
Field number(const char* name, const char* symbol, const char* unit, Range range, const char* help, double otherwise) {
  return {name, symbol, unit, Kind::number, Value(otherwise), range, help};
}
Field words(const char* name, const char* help) { return {name, "", "", Kind::text, {}, {}, help, true}; }
Field group(const char* name, const char* help, std::vector<Field> fields) {
  return {name, "", "", Kind::table, {}, {}, help, true, {}, std::move(fields)};
}
Field smoothing() {
  return number("smoothing", "", "m", not_negative, "root mean square distance of the spline from the points", 0.0);
}

}  // namespace

double WheelProfile::bounding_radius() const { return std::hypot(wheelset->half_width(), wheelset->largest_radius()); }
double WheelProfile::contact_radius() const { return wheelset->geometry.radius; }
MassProperties WheelProfile::mass_properties() const {
  return {wheelset->mass, Vec3::Zero(), Mat3(wheelset->inertia.asDiagonal())};
}

Entry WheelProfile::entry() {
  Field which{"wheel", "", "", Kind::text, Value(std::string("both")), {}, "which wheel has it"};
  which.choices = {"left", "right", "both"};
  return {
      name,
      "wheelset of two wheels of revolution on an axle along y, z down",
      {words("file",
             "CSV of y from the tape circle (flange negative) and z (increase of radius); first line `# unit: mm`"),
       words("name", "a built-in profile in place of a file: s1002, cone"),
       number("conicity", "gamma", "", {0.0, 0.5}, "of the built-in cone", 0.05),
       number("radius", "r0", "m", positive, "at the tape circle", 0.46),
       smoothing(),
       number("flange_back", "", "m", positive, "between the wheels' inner faces", 1.36),
       number("tape_circle", "", "m", positive, "from the wheel's inner face to the tape circle", 0.07),
       number("mass", "m", "kg", positive, "of the wheelset; free bodies need it"),
       {"inertia", "I", "kg m^2", Kind::vec3, {}, positive, "about x, y (the axle) and z; free bodies need it", true},
       group("flat", "a fresh flat: a chord of the wheel's circle",
             {number("length", "l", "m", {0.0, 0.3, true, false}, "along the circle"),
              number("angle_deg", "", "", any_number, "rotation of the wheel until the flat meets the rail", 0.0),
              which}),
       group("out_of_round", "radius that varies around the wheel",
             {number("amplitude", "a", "m", any_number, "of a sin(n theta)"),
              {"order", "n", "", Kind::integer, Value(1.0), {1, 500}, "waves around the wheel"},
              which})},
      {},
      ""};
}

Entry RailProfile::entry() {
  return {
      name,
      "track of two rails along x, y to the right, z down; fixed",
      {words("file",
             "CSV of y from the rail's axis (gauge side positive) and z below the top; first line `# unit: mm`"),
       words("name", "a built-in profile in place of a file: 60e1, uic60"),
       number("cant", "", "rad", {-0.5, 0.5}, "towards the gauge side", 0.0), smoothing(),
       number("gauge", "", "m", positive, "between the rails' gauge faces, 14 mm below their top", 1.435),
       group("curve", "to the right, or to the left with a negative radius",
             {number("radius", "R", "m", any_number, "of the track's middle"),
              number("start", "", "m", not_negative, "distance where the transition begins", 0.0),
              number("transition", "", "m", not_negative, "length over which curvature and superelevation grow", 0.0),
              number("superelevation", "h", "m", {0.0, 0.3}, "of the outer rail", 0.0)}),
       group("irregularity", "sinusoidal amplitudes with a wavelength, or measured",
             {words("file", "CSV of s, lateral, vertical[, cross_level][, gauge]; first line `# unit: mm`, s in m"),
              number("lateral", "", "m", any_number, "amplitude of both rails to the right", 0.0),
              number("vertical", "", "m", any_number, "amplitude of both rails downwards", 0.0),
              number("cross_level", "", "m", any_number, "amplitude of the right rail below the left", 0.0),
              number("wavelength", "L", "m", positive, "of the sines")}),
       number("drawn_length", "", "m", {1e-3, 1e4}, "of the rails in pictures", 20.0)},
      {},
      ""};
}

}  // namespace epafi
