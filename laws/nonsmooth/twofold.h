/// @file twofold.h  Numbers of twice a double's digits: the sum of two doubles, the second below half a unit in the
/// last place of the first (Dekker 1971; Knuth 1969). Relative error of an operation about 1e-31.
#pragma once
#include <cmath>

namespace epafi {

struct Twofold {
  double high = 0.0, low = 0.0;

  Twofold() = default;
  Twofold(double x) : high(x) {}  // NOLINT(google-explicit-constructor): every double is one
  /// a + b where |a| >= |b|.
  static Twofold quick(double a, double b) {
    Twofold out(a + b);
    out.low = b - (out.high - a);
    return out;
  }
  static Twofold sum(double a, double b) {
    Twofold out(a + b);
    const double c = out.high - a;
    out.low = (a - (out.high - c)) + (b - c);
    return out;
  }
  static Twofold product(double a, double b) {
    Twofold out(a * b);
    out.low = std::fma(a, b, -out.high);
    return out;
  }
  double value() const { return high + low; }

  Twofold operator-() const {
    Twofold out(-high);
    out.low = -low;
    return out;
  }
  friend Twofold operator+(const Twofold& a, const Twofold& b) {
    const Twofold s = sum(a.high, b.high), t = sum(a.low, b.low);
    const Twofold first = quick(s.high, s.low + t.high);
    return quick(first.high, first.low + t.low);
  }
  friend Twofold operator-(const Twofold& a, const Twofold& b) { return a + -b; }
  friend Twofold operator*(const Twofold& a, const Twofold& b) {
    const Twofold p = product(a.high, b.high);
    return quick(p.high, p.low + (a.high * b.low + a.low * b.high));
  }
  friend Twofold operator/(const Twofold& a, const Twofold& b) {
    const double first = a.high / b.high;
    const Twofold rest = a - b * first;
    const double second = rest.high / b.high;
    const Twofold last = rest - b * second;
    return quick(first, second) + last.high / b.high;
  }
  Twofold& operator+=(const Twofold& other) { return *this = *this + other; }
  friend bool operator<(const Twofold& a, const Twofold& b) {
    return a.high < b.high || (a.high == b.high && a.low < b.low);
  }
  friend bool operator<=(const Twofold& a, const Twofold& b) { return !(b < a); }
};

inline Twofold sqrt(const Twofold& x) {
  if (!(x.high > 0.0)) return x.high;
  const double root = std::sqrt(x.high);
  return Twofold::quick(root, (x - Twofold::product(root, root)).high / (2.0 * root));
}

}  // namespace epafi
