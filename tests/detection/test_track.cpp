// The line of a track, its irregularities, and where a wheelset stands on it.
#include <cmath>
#include <numbers>

#include "detection/profiles/wheelset_on_track.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

Track curved(double radius) {
  Track t(Profile(canted_rail(*built_in_profile("uic60"), 0.025)), {}, {radius, 10.0, 40.0, 0.1});
  return t;
}

Wheelset on_s1002() {
  Wheelset w;
  w.wheel = Profile(*built_in_profile("s1002"));
  return w;
}

}  // namespace

TEST_CASE("the frame of a track moves along its heading and a place beside it is found again", "[detection][track]") {
  for (const double radius : {300.0, -300.0}) {
    const Track t = curved(radius);
    for (const double s : {-5.0, 3.0, 10.0, 17.0, 42.0, 50.0, 60.0, 200.0}) {
      const Pose at = t.frame(s), ahead = t.frame(s + 1e-4), behind = t.frame(s - 1e-4);
      const Vec3 forward = (ahead.position - behind.position) / 2e-4;
      CHECK((forward - at.orientation * Vec3::UnitX()).norm() < 1e-7);  // of unit length, along the frame's x
      CHECK(t.distance_of(at.to_world(Vec3(0.0, 0.7, 0.0))) == Approx(s).margin(1e-9));
      CHECK(t.distance_of(at.to_world(Vec3(0.0, -0.7, -0.4))) == Approx(s).margin(1e-9));
      CHECK((t.heading(s + 1e-4) - t.heading(s - 1e-4)) / 2e-4 == Approx(t.curvature(s)).margin(1e-6));
    }
    // the whole circle: 300 m about its centre, the outer rail 0.1 m higher over 1.505 m
    CHECK((t.frame(100.0).position - t.frame(100.0 + std::numbers::pi * 300.0).position).norm() == Approx(600.0));
    const Vec3 across = t.frame(100.0).orientation * Vec3::UnitY();
    CHECK(across.z() == Approx(std::copysign(0.1 / 1.505, radius)));
  }
}

TEST_CASE("a rail's direction follows its irregularity", "[detection][track]") {
  Track t = curved(0.0);
  CHECK(t.direction(3.0, true, 0.75) == Vec3::UnitX());
  t.wave = {2e-3, 1e-3, 0.0, 10.0};
  const double k = 2.0 * std::numbers::pi / 10.0;
  for (const double s : {0.0, 1.3, 4.0}) {
    const Vec3 d = t.direction(s, true, 0.75);
    CHECK(d.y() == Approx(2e-3 * k * std::cos(k * s)).margin(1e-8));
    CHECK(d.z() == Approx(1e-3 * k * std::cos(k * s)).margin(1e-8));
    CHECK(t.shift(s, true).y == Approx(2e-3 * std::sin(k * s)).margin(1e-12));
  }
}

TEST_CASE("a measured track is read with its unit, and what is wrong with it is said", "[detection][track]") {
  const MeasuredFile ok = read_irregularity("# unit: mm\ns,lateral,vertical,gauge\n0,0,0,1435\n2,3,-1,1437\n");
  REQUIRE(ok.problem.empty());
  Track t;
  t.measured = ok.track;
  CHECK(t.shift(1.0, false).y == Approx(1.5e-3 - 0.718));
  CHECK(t.shift(9.0, true).z == Approx(-1e-3));
  CHECK(read_irregularity("s,lateral\n0,0\n").problem.find("unit") != std::string::npos);
  CHECK(read_irregularity("# unit: mm\ns,wobble\n").problem.find("wobble") != std::string::npos);
  CHECK(read_irregularity("# unit: mm\ns,lateral\n0,0\n0,1\n").problem == "s does not increase");
  CHECK(read_irregularity("# unit: mm\ns,lateral\n0,0\n1,x\n").line == 4);
}

TEST_CASE("a wheelset's place is its displacement, angles and turn against the track", "[detection][track]") {
  const Track t = curved(300.0);
  const Wheelset w = on_s1002();
  const Pose frame = t.frame(80.0);
  const double yaw = 4e-3, roll = -1e-3, rolled = 0.7;
  const Quat turn(Eigen::AngleAxisd(yaw, Vec3::UnitZ()) * Eigen::AngleAxisd(roll, Vec3::UnitX()) *
                  Eigen::AngleAxisd(-rolled, Vec3::UnitY()));
  const Pose body{frame.to_world(Vec3(0.0, 3e-3, -0.46 + 1e-4)), frame.orientation * turn};
  const PlaceOnTrack at = place_on_track(w, t, body, {});
  CHECK(at.distance == Approx(80.0).margin(1e-9));
  CHECK(at.position.lateral_shift == Approx(3e-3).margin(1e-9));
  CHECK(at.position.height == Approx(1e-4).margin(1e-9));
  CHECK(at.position.yaw == Approx(yaw).epsilon(1e-9));
  CHECK(at.position.roll == Approx(roll).epsilon(1e-9));
  CHECK(at.angle == Approx(rolled).epsilon(1e-9));
}

TEST_CASE("the search finds both wheels, mirrored like the place", "[detection][track]") {
  const Track t = curved(0.0);
  const Wheelset w = on_s1002();
  WheelsetOnTrack search(w, t);
  const auto stand = stand_on_rails(w.wheel, t.rail, w.geometry, {2e-3, 0.0, 0.0, 0.0});
  const auto find = [&](double side) {
    std::vector<RollingRegion> all;
    const Quat turn(Eigen::AngleAxisd(side * stand.position.roll, Vec3::UnitX()));
    search.find({Vec3(5.0, side * 2e-3, -0.46 + stand.position.height + 5e-5), turn}, {}, 0.0, true, all);
    return all;
  };
  const auto right = find(1.0), left = find(-1.0);
  REQUIRE(right.size() == 2);
  REQUIRE(left.size() == 2);
  CHECK(right[0].mirrored);
  CHECK_FALSE(right[1].mirrored);
  for (const auto& r : right) CHECK(r.approach == Approx(5e-5 * std::cos(r.region.angle)).margin(1e-9));
  CHECK(right[0].approach == Approx(left[1].approach).margin(1e-12));
  CHECK(right[0].point.y() == Approx(-left[1].point.y()).margin(1e-9));
  CHECK(right[1].region.y_rail == Approx(left[0].region.y_rail).margin(1e-9));
  CHECK(right[0].region.y_rail == Approx(stand.left.y_rail).margin(2e-6));
}

TEST_CASE("a flat lowers the axle by its depth and sets the contact on its edge", "[detection][track]") {
  const WheelDefect flat{0.04, 0.5, 0.0, 1, true, true};
  const double R = 0.46, half = 0.02 / R;
  CHECK(flat.drop(0.5, R) == Approx(0.04 * 0.04 / (8.0 * R)).epsilon(1e-3));
  CHECK(flat.drop(0.5 + half, R) == Approx(0.0).margin(1e-12));
  CHECK(flat.drop(0.5 - 2.0 * half, R) == 0.0);
  CHECK(flat.drop(0.5 + 2.0 * std::numbers::pi, R) == Approx(flat.drop(0.5, R)));
  for (const double angle : {0.47, 0.49, 0.51, 0.53})
    CHECK(flat.offset(angle, R) ==
          Approx((flat.drop(angle + 1e-6, R) - flat.drop(angle - 1e-6, R)) / 2e-6).margin(1e-7));
  CHECK(std::abs(flat.offset(0.5 - 1e-9, R)) == Approx(0.02).epsilon(1e-3));  // half of its length
}
