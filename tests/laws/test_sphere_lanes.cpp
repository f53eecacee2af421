#include "laws/smooth/fused/sphere_lanes.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("two and six numbers a contact come out of columns as rows, whatever the width", "[laws][fused]") {
  VectorsOf<LanesOf<8>::Real> a, b;
  for (int l = 0; l < 8; ++l) {
    const double first = 10.0 * l;
    a.x[l] = first + 1;
    a.y[l] = first + 2;
    a.z[l] = first + 3;
    b.x[l] = first + 4;
    b.y[l] = first + 5;
    b.z[l] = first + 6;
  }
  LanesOf<8>::Real rows[8];
  write_sixes(a, b, rows);
  for (int l = 0; l < 8; ++l)
    for (int k = 0; k < 8; ++k) CHECK(rows[l][k] == (k < 6 ? 10.0 * l + k + 1 : 0.0));
  LanesOf<2>::Real twos[4];
  write_twos(Lanes{1, 2, 3, 4}, Lanes{5, 6, 7, 8}, twos);
  for (int l = 0; l < 4; ++l) CHECK((twos[l][0] == l + 1 && twos[l][1] == l + 5));
  write_twos(LanesOf<2>::Real{1, 2}, LanesOf<2>::Real{5, 6}, twos);
  for (int l = 0; l < 2; ++l) CHECK((twos[l][0] == l + 1 && twos[l][1] == l + 5));
  const Lanes turned = turn_three(Lanes{1, -2, 0, 4});
  CHECK((turned[0] == -1 && turned[1] == 2 && std::signbit(turned[2]) && turned[3] == 4));
}
