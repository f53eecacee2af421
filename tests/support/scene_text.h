/// @file scene_text.h  Tables that scenes of several tests share.
#pragma once
#include <string>

namespace epafi::experiments {

/// Gravity downwards; soft glass that bounces and rubs by smooth laws.
inline std::string soft_glass() {
  return R"toml(
[world]
gravity = [0, 0, -9.81]
[material.glass]
density = 2500.0
youngs_modulus = "5 MPa"
poissons_ratio = 0.25
[contact]
method = "smooth"
restitution = 0.5
friction = 0.4
)toml";
}

/// The half-space z < 0 at rest.
inline std::string half_space_floor(const std::string& material) {
  return "[[body]]\nname = \"floor\"\nshape = { half_space = { normal = [0, 0, 1] } }\nmaterial = \"" + material +
         "\"\nfixed = true\n";
}

/// A measure of what acts between two bodies.
inline std::string contact_measure(const std::string& name, const std::string& a, const std::string& b) {
  return "[[measure]]\nname = \"" + name + "\"\nkind = \"contact\"\nbetween = [\"" + a + "\", \"" + b + "\"]\n";
}

/// The velocity of a body, under the body's name.
inline std::string velocity_measure(const std::string& body) {
  return "[[measure]]\nname = \"" + body + "\"\nkind = \"velocity\"\nbody = \"" + body + "\"\n";
}

}  // namespace epafi::experiments
