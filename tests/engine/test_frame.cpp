#include "engine/state/frame.h"

#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {
/// Largest deviation from a right-handed orthonormal frame.
double defect(const ContactFrame& f) {
  Mat3 m;
  m << f.normal, f.tangent1, f.tangent2;
  return std::max((m.transpose() * m - Mat3::Identity()).cwiseAbs().maxCoeff(),
                  (f.normal.cross(f.tangent1) - f.tangent2).norm());
}
}  // namespace

TEST_CASE("contact frames are right-handed and orthonormal in every direction", "[engine][frame]") {
  // Duff et al. 2017: error of the frame is that of the normal; 1e-15 in double
  Random random(1, 1);
  double worst = 0;
  for (int k = 0; k < 100000; ++k) {
    Vec3 n;
    do n = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    while (n.norm() < 0.1 || n.norm() > 1);
    worst = std::max(worst, defect(contact_frame(n.normalized())));
  }
  CHECK(worst < 2e-15);
  for (const Vec3& n :
       {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0, 1, -0.0)})
    CHECK(defect(contact_frame(n)) < 1e-15);
}

TEST_CASE("the frame is accurate near the pole where older formulas divide by zero", "[engine][frame]") {
  for (double e = 1e-1; e > 1e-12; e /= 10) {
    for (double sign : {1.0, -1.0}) CHECK(defect(contact_frame(Vec3(e, -0.3 * e, sign).normalized())) < 2e-15);
  }
}

TEST_CASE("the frame turns little when the normal turns little, on each side of z = 0", "[engine][frame]") {
  Random random(2, 1);
  for (int k = 0; k < 1000; ++k) {
    Vec3 n;
    do n = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    while (n.norm() < 0.1 || std::abs(n.normalized().z()) < 1e-3);
    n.normalize();
    const Vec3 m = (n + 1e-6 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))).normalized();
    // the derivative of the frame is at most 2 + 2/(1 + |z|) <= 4 in every component
    CHECK((contact_frame(n).tangent1 - contact_frame(m).tangent1).norm() < 8e-6);
    CHECK((contact_frame(n).tangent2 - contact_frame(m).tangent2).norm() < 8e-6);
  }
}
