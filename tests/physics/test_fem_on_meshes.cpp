// Finite elements whose gaps are projections between two meshes (detection/surfaces) against closed forms.
#include <cmath>

#include "detection/surfaces/surface_gap.h"
#include "laws/wheel_rail/fem/mesh_gaps.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

constexpr double nu = 0.3, modulus = 210e9 / 2.0 / (1.0 - nu * nu), A = 0.5 / 0.3, N = 80e3;  // a ball of 300 mm

/// h = lift + slope x + A (x^2 + y^2).
class Paraboloid final : public GapSource {
 public:
  Paraboloid(double curvature, double slope, double lift) : A_(curvature), slope_(slope), lift_(lift) {}
  std::vector<ContactRegion> regions() const override { return {ContactRegion{}}; }
  ContactRegion moved(const ContactRegion& region, double, double) const override { return region; }
  double angle_at(const ContactRegion&, double) const override { return 0.0; }
  GapField field(const ContactRegion&, double cx, double cy, double dx, double dy, std::size_t nx,
                 std::size_t ny) const override {
    return GapField::of(cx, cy, dx, dy, nx, ny, [&](double x, double y) {
      return x > hole ? std::nan("") : lift_ + slope_ * x + A_ * (x * x + y * y);
    });
  }
  std::unique_ptr<GapOperator> gaps_between(GapMethod method, std::span<const Vec3> nodes,
                                            std::span<const Triangle> first, std::span<const Triangle> second,
                                            double band) const override {
    return make_gap_operator(method, nodes, first, second, band);
  }
  double hole = infinity;  ///< no surface beyond this x

 private:
  double A_, slope_, lift_;
};

struct Block {
  BlockMesh mesh;
  Eigen::MatrixXd W;
  explicit Block(int across)
      : mesh(make_block_mesh(0.0, 0.0, 1.25 * radius(), 1.25 * radius(), across, 1.6, 6.0)),
        W(surface_flexibility(mesh, modulus * (1.0 - nu * nu), nu)) {}
  static double radius() { return hertz_of_force(A, A, modulus, N).ellipse.a; }
};

/// A thousandth of the elastic compliance, of a node or over the surface.
double stiff(GapMethod method) {
  return method == GapMethod::node_to_surface ? 1e2 * modulus * Block::radius() : 1e3 * modulus / Block::radius();
}

constexpr GapMethod methods[] = {GapMethod::node_to_surface, GapMethod::surface_to_surface};

}  // namespace

TEST_CASE("a ball meshed for itself presses a meshed block as Hertz' does, by nodes and over the surface",
          "[physics][wheel_rail][fem]") {
  const HertzContact h = hertz_of_force(A, A, modulus, N);
  const Block block(8);
  for (const GapMethod method : methods) {
    MeshGaps gaps(block.mesh, Paraboloid(A, 0.0, 0.0), {}, method);
    const SurfaceContact s = gaps.solve(block.W, {true, N}, Enforcement::augmented_lagrangian, stiff(method));
    REQUIRE_FALSE(gaps.incomplete());
    CHECK(s.report.converged);
    CHECK(s.force == Approx(N).epsilon(1e-9));
    CHECK(gaps.force().sum() == Approx(N).epsilon(1e-9));
    CHECK(s.approach == Approx(h.approach).epsilon(0.02));  // 8 elements across: 0.7 % from the elements themselves
    // nothing is left open or overlapping: under load the nodes that carry lie on the ball, its chords 4e-4 away
    const Eigen::VectorXd moved = block.W * gaps.force();
    for (Eigen::Index k = 0; k < moved.size(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double x = block.mesh.candidate_x(i), y = block.mesh.candidate_y(i);
      const double gap = A * (x * x + y * y) + moved[k] - s.approach;
      if (method == GapMethod::node_to_surface && gaps.force()[k] > 0.0) CHECK(std::abs(gap) < 1e-3 * s.approach);
      if (method == GapMethod::node_to_surface) CHECK(gap > -1e-3 * s.approach);
    }
  }
}

TEST_CASE("a tilted ball is the same ball elsewhere: gaps count along the normal, not along z",
          "[physics][wheel_rail][fem]") {
  // h = A (x + s/2A)^2 - s^2/4A + A y^2: lowest at x = -s/2A; a slope of 2 % moves it by 6 mm, so a tenth of that
  const Block block(8);
  const double slope = 2e-3, shift = 0.5 * slope / A, sunk = 0.25 * slope * slope / A;
  for (const GapMethod method : methods) {
    MeshGaps level(block.mesh, Paraboloid(A, 0.0, 0.0), {}, method),
        tilted(block.mesh, Paraboloid(A, slope, sunk), {}, method);
    const SurfaceContact at_rest = level.solve(block.W, {true, N}, Enforcement::augmented_lagrangian, stiff(method));
    const SurfaceContact moved = tilted.solve(block.W, {true, N}, Enforcement::augmented_lagrangian, stiff(method));
    double centre = 0.0;
    for (Eigen::Index k = 0; k < tilted.force().size(); ++k)
      centre += tilted.force()[k] * block.mesh.candidate_x(static_cast<std::size_t>(k)) / N;
    CHECK(centre == Approx(-shift).epsilon(0.1));  // a tenth of an element
    CHECK(moved.approach == Approx(at_rest.approach).epsilon(0.01));
  }
}

TEST_CASE("flat surfaces at a distance close it exactly and press like a punch", "[physics][wheel_rail][fem]") {
  const Block block(4);
  for (const GapMethod method : methods) {
    const double lift = 1e-3;
    MeshGaps flat(block.mesh, Paraboloid(0.0, 0.0, lift), {}, method);
    const SurfaceContact s = flat.solve(block.W, {true, N}, Enforcement::lagrange, 0.0);
    const Eigen::VectorXd moved = block.W * flat.force();
    CHECK(s.penetration < 1e-12);
    CHECK(s.approach > lift);
    if (method == GapMethod::node_to_surface)
      CHECK((moved.array() - (s.approach - lift)).abs().maxCoeff() < 1e-9 * s.approach);  // all sink alike
    // J. Boussinesq: N = 2 a E* depth for a round punch; a square of half side b lies between those of radius b and
    // sqrt(2) b
    const double b = 1.25 * Block::radius(), depth = s.approach - lift;
    CHECK(depth < N / (2.0 * b * modulus) * 1.05);
    CHECK(depth > N / (2.0 * std::sqrt(2.0) * b * modulus));
  }
}

TEST_CASE("a surface that ends over the patch is said", "[physics][wheel_rail][fem]") {
  const Block block(4);
  Paraboloid half(A, 0.0, 0.0);
  half.hole = -1.0;
  MeshGaps none(block.mesh, half, {}, GapMethod::node_to_surface);
  CHECK(none.incomplete());
}
