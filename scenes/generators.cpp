#include "scenes/generators.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/units/random.h"

namespace epafi {

namespace {

/// Mean and standard deviation of the logarithm of the size.
std::pair<double, double> of_logarithm(const FillSpec::Size& s) {
  const double ratio = s.deviation / s.mean, variance = std::log1p(ratio * ratio);
  return {std::log(s.mean) - 0.5 * variance, std::sqrt(variance)};
}

/// One draw of a standard normal number (Box and Muller 1958).
double draw_normal(Random& random) {
  const double u = 1.0 - random.uniform(), v = random.uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2 * M_PI * v);
}

double draw_size(const FillSpec::Size& s, Random& random) {
  if (s.distribution == "uniform") return s.min + (s.max - s.min) * random.uniform();
  if (s.distribution == "table") {
    double total = 0;
    for (double share : s.shares) total += share;
    double pick = random.uniform() * total;
    std::size_t k = 0;
    while (k + 1 < s.shares.size() && pick >= s.shares[k]) pick -= s.shares[k++];
    return s.values[k];
  }
  const auto [mean, deviation] = of_logarithm(s);
  double f = s.mean;
  for (int trial = 0; trial < 1000; ++trial) {  // what the bounds cut off is drawn again
    const double g = draw_normal(random);
    f = s.distribution == "normal" ? s.mean + s.deviation * g : std::exp(mean + deviation * g);
    if (f >= s.min && f <= s.max) return f;
  }
  return std::clamp(f, s.min, s.max);  // bounds so narrow hold nothing but themselves
}

/// Draws the next body, independent of the other bodies placed.
FillBody draw(const FillSpec& fill, const std::vector<FillShape>& shapes, Random& random) {
  FillBody body;
  double total = 0;
  for (double w : fill.weights) total += w;
  double pick = random.uniform() * total;
  while (body.shape + 1 < fill.weights.size() && pick >= fill.weights[body.shape]) pick -= fill.weights[body.shape++];
  if (fill.size)
    body.size = draw_size(*fill.size, random);
  else
    random.bits();
  if (!shapes[body.shape].is_sphere) {  // uniform on the rotations (Shoemake 1992)
    const double a = random.uniform(), b = 2 * M_PI * random.uniform(), c = 2 * M_PI * random.uniform();
    body.orientation = Quat(std::sqrt(a) * std::cos(c), std::sqrt(1 - a) * std::sin(b), std::sqrt(1 - a) * std::cos(b),
                            std::sqrt(a) * std::sin(c));
  }
  return body;
}

/// Compares the bodies placed with the required amount.
class Quota {
 public:
  explicit Quota(const FillSpec& fill) : fill_(fill) {}
  bool wants_more(double next_mass) const {
    if (fill_.count) return placed_ < *fill_.count;
    if (fill_.mass) return mass_ + 0.5 * next_mass <= *fill_.mass;  // the nearest total
    return true;
  }
  void place(double mass) {
    ++placed_;
    mass_ += mass;
  }
  std::string shortfall() const {
    if (fill_.full) return {};
    if (fill_.count) return fmt::format("only {} of {} bodies fit into the region", placed_, *fill_.count);
    return fmt::format("only {:g} of {:g} kg fit into the region", mass_, *fill_.mass);
  }

 private:
  const FillSpec& fill_;
  std::uint64_t placed_ = 0;
  double mass_ = 0;
};

double largest_radius(const FillSpec& fill, const std::vector<FillShape>& shapes) {
  double r = 0;
  for (const auto& s : shapes) r = std::max(r, s.radius);
  return r * (fill.size ? fill.size->max : 1.0);
}

double mass_of(const FillBody& b, const std::vector<FillShape>& shapes) {
  return shapes[b.shape].mass * b.size * b.size * b.size;
}

/// Cubic cells of one body each.
struct Lattice {
  std::array<std::uint64_t, 3> cells{};
  Vec3 cell;  ///< edges [m]
  std::uint64_t size() const { return cells[0] * cells[1] * cells[2]; }

  Lattice(const FillSpec& fill, double largest) {
    const double pitch = 2.04 * largest;
    const Vec3 extent = fill.region.max - fill.region.min;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      cells[i] = static_cast<std::uint64_t>(std::max(0.0, std::floor(extent[k] / pitch * (1 + 1e-12))));
      cell[k] = k < 2 ? extent[k] / static_cast<double>(std::max<std::uint64_t>(1, cells[i])) : pitch;
    }
  }
  /// Random position in cell n.
  Vec3 place(const FillSpec& fill, std::uint64_t n, double radius, Random& random) const {
    const std::uint64_t column = n % cells[0], row = n / cells[0] % cells[1], layer = n / (cells[0] * cells[1]);
    const Vec3 index(static_cast<double>(column), static_cast<double>(row), static_cast<double>(layer));
    Vec3 x;
    for (int k = 0; k < 3; ++k)
      x[k] = fill.region.min[k] + (index[k] + 0.5) * cell[k] + (0.5 * cell[k] - radius) * random.uniform(-1, 1);
    return x;
  }
};

FillResult lattice(const FillSpec& fill, const std::vector<FillShape>& shapes, Obstacles& obstacles) {
  constexpr int tries = 3;
  const Lattice places(fill, largest_radius(fill, shapes));
  FillResult result;
  Quota quota(fill);
  std::uint64_t next = 0;  // cell
  for (std::uint64_t n = 0;; ++n) {
    Random random(fill.seed, n);
    FillBody body = draw(fill, shapes, random);
    const double mass = mass_of(body, shapes), radius = shapes[body.shape].radius * body.size;
    if (!quota.wants_more(mass)) return result;
    bool placed = false;
    for (; next < places.size() && !placed; ++next)
      for (int t = 0; t < tries && !placed; ++t) {
        body.position = places.place(fill, next, radius, random);
        placed = obstacles.is_free(body, radius);
      }
    if (!placed) break;
    if (obstacles.keep) obstacles.occupied.add(body.position, radius);
    result.bodies.push_back(body);
    quota.place(mass);
  }
  result.shortfall = quota.shortfall();
  return result;
}

/// Bodies without positions, for a source that pours them.
FillResult stream(const FillSpec& fill, const std::vector<FillShape>& shapes) {
  FillResult result;
  Quota quota(fill);
  for (std::uint64_t n = 0;; ++n) {
    Random random(fill.seed, n);
    const FillBody body = draw(fill, shapes, random);
    const double mass = mass_of(body, shapes);
    if (!quota.wants_more(mass)) return result;
    result.bodies.push_back(body);
    quota.place(mass);
  }
}

FillResult random_insertion(const FillSpec& fill, const std::vector<FillShape>& shapes, Obstacles& obstacles) {
  constexpr int trials = 200;
  const double largest = largest_radius(fill, shapes);
  FillResult result;
  Quota quota(fill);
  double low = fill.region.min.z();
  for (std::uint64_t n = 0;; ++n) {
    Random random(fill.seed, n);
    FillBody body = draw(fill, shapes, random);
    const double radius = shapes[body.shape].radius * body.size, mass = mass_of(body, shapes);
    if (!quota.wants_more(mass)) return result;
    bool placed = false;
    while (!placed && low + 2 * radius <= fill.region.max.z()) {
      const double high = std::min(fill.region.max.z(), low + 4 * largest);
      for (int t = 0; t < trials && !placed; ++t) {
        // drawn one by one, since compilers differ in the order of evaluating arguments (GCC from the last, Clang from
        // the first)
        const double uz = random.uniform(), uy = random.uniform(), ux = random.uniform();
        const Vec3 u(ux, uy, uz);
        const Vec3 from(fill.region.min.x() + radius, fill.region.min.y() + radius, low + radius);
        const Vec3 to(fill.region.max.x() - radius, fill.region.max.y() - radius, high - radius);
        if ((to - from).minCoeff() < 0) break;
        body.position = from + u.cwiseProduct(to - from);
        placed = obstacles.is_free(body, radius);
      }
      if (!placed) low += largest;
    }
    if (!placed) break;
    obstacles.occupied.add(body.position, radius);
    result.bodies.push_back(body);
    quota.place(mass);
  }
  result.shortfall = quota.shortfall();
  return result;
}

/// Draws velocities of zero total momentum: the mean velocity stays that of the fill.
void draw_velocities(const FillSpec& fill, const std::vector<FillShape>& shapes, std::vector<FillBody>& bodies) {
  constexpr std::uint64_t velocities = 1ull << 62;  // streams of their own: places do not depend on them
  Vec3 momentum = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    FillBody& b = bodies[k];
    Random random(fill.seed, velocities | k);
    for (double& v : b.velocity) v = fill.velocity_deviation * draw_normal(random);
    const double m = shapes[b.shape].mass * b.size * b.size * b.size;
    momentum += m * b.velocity;
    mass += m;
  }
  for (FillBody& b : bodies) b.velocity -= momentum / mass;
}

}  // namespace

SizeBounds natural_bounds(const FillSpec::Size& s) {
  if (s.distribution == "normal") return {s.mean - 3 * s.deviation, s.mean + 3 * s.deviation};
  const auto [mean, deviation] = of_logarithm(s);
  return {std::exp(mean - 3 * deviation), std::exp(mean + 3 * deviation)};
}

FillResult generate(const FillSpec& fill, const std::vector<FillShape>& shapes, Obstacles& obstacles) {
  FillResult result = fill.method == FillSpec::Method::pour      ? stream(fill, shapes)
                      : fill.method == FillSpec::Method::lattice ? lattice(fill, shapes, obstacles)
                                                                 : random_insertion(fill, shapes, obstacles);
  if (fill.velocity_deviation > 0.0) draw_velocities(fill, shapes, result.bodies);
  return result;
}

FillResult generate(const FillSpec& fill, const std::vector<FillShape>& shapes) {
  Obstacles none;
  return generate(fill, shapes, none);
}

double most_bodies_of(const FillSpec& fill, const std::vector<FillShape>& shapes) {
  if (fill.count) return static_cast<double>(*fill.count);
  constexpr std::uint64_t samples = 256;
  double mass = 0.0, ball = 0.0;  // means
  for (std::uint64_t n = 0; n < samples; ++n) {
    Random random(fill.seed, n);
    const FillBody body = draw(fill, shapes, random);
    const double radius = shapes[body.shape].radius * body.size;
    mass += mass_of(body, shapes) / samples;
    ball += 4.0 / 3.0 * M_PI * radius * radius * radius / samples;
  }
  const double wanted = fill.mass ? *fill.mass / mass : infinity;
  if (fill.method == FillSpec::Method::pour) return wanted;
  constexpr double densest = 0.74;  // of equal balls, which no placing reaches
  return std::min(wanted, densest * (fill.region.max - fill.region.min).prod() / ball);
}

}  // namespace epafi
