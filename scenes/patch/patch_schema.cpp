#include "scenes/patch/patch_schema.h"

#include "laws/wheel_rail/normal_models.h"
#include "laws/wheel_rail/tangential_models.h"
#include "scenes/reader/fields.h"

namespace epafi {
namespace {

Field number(std::string name, std::string symbol, std::string unit, Range range, std::string help) {
  return optional(std::move(name), std::move(symbol), std::move(unit), Kind::number, range, std::move(help));
}
Field infinite(Field f) {
  f.may_be_infinite = true;
  return f;
}
Field words(std::string name, std::string help, Range count, std::vector<std::string> choices) {
  Field f{std::move(name), "", "", Kind::texts, std::nullopt, count, std::move(help)};
  f.optional = true;
  f.choices = std::move(choices);
  return f;
}
template <class List>
std::vector<std::string> names(const List& list) {
  std::vector<std::string> out;
  for (const auto& item : list) out.push_back(item.entry.name);
  return out;
}

Field side_field() {
  Field f{"side", "", "", Kind::text, Value(std::string("right")), {}, "of the track"};
  f.choices = {"left", "right"};
  return f;
}

}  // namespace

std::vector<Field> patch_fields() {
  const Range some{1, infinity}, any{0, infinity}, two{2, 2};
  Field normal = words("normal", "normal models", some, names(all_normal_models()));
  normal.default_value = Value(std::vector<std::string>{"hertz"});
  return {
      number("load", "N", "N", positive, "normal load; with profiles vertical, per wheel"),
      number("approach", "delta", "m", positive, "approach of the bodies in place of a load"),
      table("radii", "principal radii of both bodies; inf is flat, negative is concave",
            {needed(infinite(number("x1", "R_x1", "m", any_number, "first body, along x"))),
             needed(infinite(number("x2", "R_x2", "m", any_number, "second body, along x"))),
             needed(infinite(number("y1", "R_y1", "m", any_number, "first body, along y"))),
             needed(infinite(number("y2", "R_y2", "m", any_number, "second body, along y")))}),
      number("length", "l", "m", positive, "length of a line contact"),
      table("semi_axes", "a given ellipse of Hertzian pressure",
            {needed(number("a", "a", "m", positive, "along x")), needed(number("b", "b", "m", positive, "along y"))}),
      table("creepage", "of the rail against the wheel over the speed",
            {with_default(number("longitudinal", "xi", "", any_number, "along x"), 0.0),
             with_default(number("lateral", "eta", "", any_number, "along y"), 0.0),
             with_default(number("spin", "phi", "1/m", any_number, "about the normal"), 0.0)}),
      number("distance", "s", "m", positive,
             "distance rolled from rest (half-space-start); times creepage: the shift of half-space-shift; default: "
             "the length of the patch"),
      normal,
      words("tangential", "tangential models", any, names(all_tangential_models())),
      table(
          "grid", "cells; default: 32 along the shorter axis",
          {needed(number("dx", "dx", "m", positive, "along x")), needed(number("dy", "dy", "m", positive, "along y"))}),
      table(
          "influence", "influence of separate regions on each other, by the distance between their edges",
          {with_default(infinite(number("full", "", "m", not_negative, "full influence up to this distance")), 4e-3),
           with_default(infinite(number("none", "", "m", not_negative, "no influence from this distance on")), 8e-3)}),
      with_default(number("penalty", "epsilon_N / (E* a)", "", positive,
                          "stiffness of a node of fem-penalty and fem-augmented over E* a"),
                   100.0),
      with_default(number("lateral_shift", "y", "m", any_number, "of the wheelset to the right"), 0.0),
      with_default(number("yaw", "psi", "rad", {-0.2, 0.2}, "of the wheelset, x towards y"), 0.0),
      number("roll", "phi", "rad", {-0.2, 0.2},
             "of the wheelset, y towards z; default: from the contact of both wheels"),
      with_default(number("gauge", "", "m", positive, "between the rails' gauge faces, 14 mm below their top"), 1.435),
      with_default(number("flange_back", "", "m", positive, "between the wheels' inner faces"), 1.36),
      with_default(number("tape_circle", "", "m", positive, "from the wheel's inner face to the tape circle"), 0.07),
      number("rolling_radius", "", "m", positive, "speed over angular velocity; default: the mean of both wheels"),
      side_field(),
      words("materials", "those of the two bodies", two, {})};
}

std::vector<Field> patch_contact_fields() {
  return {number("friction", "mu", "", {0.0, 10.0}, "coefficient of friction, at rest if it falls with slip"),
          number("friction_limit", "A", "", unit_interval, "friction at high slip velocity over that at rest"),
          number("friction_decay", "B", "s/m", not_negative, "decay of friction with slip velocity"),
          number("speed", "V", "m/s", not_negative, "rolling speed, for friction that falls with slip velocity")};
}

std::vector<Field> patch_material_fields() {
  return {number("youngs_modulus", "E", "Pa", positive, "Young's modulus"),
          number("shear_modulus", "G", "Pa", positive, "shear modulus in place of Young's modulus"),
          needed(number("poissons_ratio", "nu", "", {0.0, 0.5}, "Poisson's ratio")),
          number("density", "rho", "kg/m^3", positive, "not used in statics"),
          number("shear_yield", "k", "Pa", positive, "yield stress in shear: gives shakedown point and fatigue index")};
}

}  // namespace epafi
