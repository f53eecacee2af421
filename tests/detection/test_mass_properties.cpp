#include "detection/mass_properties.h"

#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

TEST_CASE("the surface of a box has the mass properties of a box, turned and shifted", "[detection][mass]") {
  Random random(11, 0);
  for (int k = 0; k < 200; ++k) {
    const Vec3 half = random_point(random, 0.1, 2.0);
    const Quat turn = random_turn(random);
    const Vec3 shift = random_point(random, -3, 3);
    const MassProperties m = surface_mass_properties(moved(box_surface(half), turn, shift));
    const double volume = 8 * half.prod();
    const Vec3 sq = half.cwiseProduct(half);
    // I = m/3 (b^2 + c^2) about the half edges
    const Mat3 principal = Vec3(volume / 3 * (Vec3::Constant(sq.sum()) - sq)).asDiagonal();
    const Mat3 r = turn.toRotationMatrix();
    CHECK(m.mass == Approx(volume).epsilon(1e-13));
    CHECK((m.centre - shift).norm() < 1e-14 * (shift.norm() + half.norm()) * 10);
    // 12 tetrahedra and coordinates rounded at |shift|: some tens of eps
    CHECK((m.inertia - r * principal * r.transpose()).norm() <
          1e-13 * principal.norm() * (1 + shift.norm() / half.minCoeff()));
  }
}

TEST_CASE("a tetrahedron has the inertia of its closed form", "[detection][mass]") {
  // corners 0, a e_x, b e_y, c e_z: V = abc/6, centre (a, b, c)/4; about the corner 0 the integral of x^2 is V a^2/10
  // and that of xy is V ab/20 (Tonon 2004)
  const double a = 0.3, b = 1.7, c = 0.9;
  const TriangleSurface s{{{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const MassProperties m = surface_mass_properties(s);
  const double v = a * b * c / 6;
  Mat3 about_corner;
  about_corner << b * b + c * c, -a * b / 2, -a * c / 2, -a * b / 2, a * a + c * c, -b * c / 2, -a * c / 2, -b * c / 2,
      a * a + b * b;
  about_corner *= v / 10;
  CHECK(m.mass == Approx(v).epsilon(1e-14));
  CHECK((m.centre - Vec3(a, b, c) / 4).norm() < 1e-15);
  CHECK((inertia_about_origin(m) - about_corner).norm() < 1e-14 * about_corner.norm());
}

TEST_CASE("a prism with many sides has the inertia of its polygon", "[detection][mass]") {
  // regular n-gon of radius r: A = n/2 r^2 sin(2 pi/n), polar moment A r^2/6 (2 + cos(2 pi/n))
  const std::uint32_t n = 400;
  const double r = 0.4, h = 0.7, angle = 2 * pi / n;
  const MassProperties m = surface_mass_properties(prism_surface(n, r, h));
  const double area = n / 2.0 * r * r * std::sin(angle), v = area * 2 * h;
  const double polar = v * r * r / 6 * (2 + std::cos(angle));
  CHECK(m.mass == Approx(v).epsilon(1e-13));
  CHECK(m.inertia(2, 2) == Approx(polar).epsilon(1e-13));
  CHECK(m.inertia(0, 0) == Approx(polar / 2 + v * h * h / 3).epsilon(1e-13));
  CHECK(m.inertia(1, 1) == Approx(polar / 2 + v * h * h / 3).epsilon(1e-13));
}

TEST_CASE("mass properties keep their digits a thousand sizes away from the origin", "[detection][mass]") {
  const Vec3 half(0.5, 0.25, 0.125), far(1024, -2048, 512);  // powers of two: the shifted corners are exact
  const MassProperties m = surface_mass_properties(moved(box_surface(half), Quat(1, 0, 0, 0), far));
  const MassProperties here = surface_mass_properties(box_surface(half));
  CHECK(m.mass == here.mass);
  CHECK((m.centre - far).norm() == 0.0);
  CHECK((m.inertia - here.inertia).norm() == 0.0);
}

TEST_CASE("scale: mass properties of bodies from a micrometre to a kilometre", "[detection][mass]") {
  for (const double size : {1e-6, 1e-3, 1.0, 1e3}) {
    const MassProperties m = surface_mass_properties(box_surface(Vec3(0.5, 1.0, 1.5) * size));
    CHECK(m.mass == Approx(6 * size * size * size).epsilon(1e-14));
    CHECK(m.inertia(0, 0) == Approx(6.0 / 12 * (4 + 9) * std::pow(size, 5)).epsilon(1e-13));
  }
}

TEST_CASE("a surface that is inside out has a negative volume and the same centre", "[detection][mass]") {
  auto s = moved(box_surface({1, 2, 3}), Quat(1, 0, 0, 0), {1, 1, 1});
  for (auto& t : s.triangles) std::swap(t[1], t[2]);
  const MassProperties m = surface_mass_properties(s);
  CHECK(m.mass == Approx(-48).epsilon(1e-14));
  CHECK((m.centre - Vec3(1, 1, 1)).norm() < 1e-15);
}

TEST_CASE("the principal frame diagonalises the inertia and leads back to the author's axes", "[detection][mass]") {
  Random random(12, 0);
  for (int k = 0; k < 500; ++k) {
    const Vec3 half = random_point(random, 0.1, 2.0);
    const auto s = moved(box_surface(half), random_turn(random), random_point(random));
    const MassProperties m = surface_mass_properties(s);
    const PrincipalFrame frame = principal_frame(m);
    const Mat3 r = frame.orientation.toRotationMatrix();
    const Mat3 moments = frame.moments.asDiagonal();
    CHECK((r * moments * r.transpose() - m.inertia).norm() < 1e-12 * m.inertia.norm());
    CHECK(r.determinant() == Approx(1.0).epsilon(1e-14));
    CHECK((frame.to_author(frame.to_principal(s.vertices[3])) - s.vertices[3]).norm() < 1e-14);
    // least turn among the 24 namings: no axis can be renamed to lie nearer, so the trace is at least that of any of
    // them
    CHECK(r.trace() >=
          1.0);  // worst case over all orientations of a cube's 24 symmetries is 1 + 2 cos(62.8 deg) = 1.914
    auto in_frame = s;
    for (Vec3& v : in_frame.vertices) v = frame.to_principal(v);
    const MassProperties again = surface_mass_properties(in_frame);
    CHECK(again.centre.norm() < 1e-14);
    CHECK((again.inertia - moments).norm() < 1e-12 * moments.norm());
  }
}

TEST_CASE("aligned bodies, cubes and tops keep the author's axes to the last bit", "[detection][mass]") {
  for (const Vec3& half : {Vec3(1, 1, 1), Vec3(1, 2, 3), Vec3(3, 2, 1), Vec3(2, 1, 2), Vec3(0.1, 0.7, 0.7)}) {
    const PrincipalFrame frame = principal_frame(surface_mass_properties(box_surface(half)));
    CHECK(frame.orientation.coeffs() == Quat(1, 0, 0, 0).coeffs());
    CHECK(frame.centre.norm() < 1e-15);
  }
  // a cube that is turned keeps its author's axes: all axes are principal
  Random random(13, 0);
  for (int k = 0; k < 100; ++k) {
    const auto cube = moved(box_surface({0.5, 0.5, 0.5}), random_turn(random), random_point(random));
    CHECK(principal_frame(surface_mass_properties(cube)).orientation.coeffs() == Quat(1, 0, 0, 0).coeffs());
  }
}

TEST_CASE("the axis of a turned top is found although the other two are not unique", "[detection][mass]") {
  Random random(14, 0);
  for (int k = 0; k < 100; ++k) {
    const Quat turn = random_turn(random);
    const auto s = moved(prism_surface(12, 0.5, 2.0), turn, {0, 0, 0});
    const PrincipalFrame frame = principal_frame(surface_mass_properties(s));
    int axis = 0;
    frame.moments.minCoeff(&axis);  // long: least moment along the axis
    const Vec3 found = frame.orientation * Vec3::Unit(axis);
    CHECK(std::abs(found.dot(turn * Vec3::UnitZ())) == Approx(1.0).epsilon(1e-14));
  }
}
