// A law asked for a whole tile of contacts answers with the bits of the law asked for one, whatever the lanes.
#include <cmath>
#include <random>

#include "engine/lanes/targets.h"
#include "laws/lane_choice.h"
#include "laws/smooth/passes/tile_passes.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// Four pairs of materials with the numbers of `law`.
SmoothLaw law_with(const std::string& law, bool locate) {
  SmoothSetup setup;
  setup.law = law;
  setup.locate = locate;
  setup.materials = {2, std::vector<MaterialPair>(4)};
  for (std::size_t i = 0; i < 4; ++i) {
    MaterialPair& pair = setup.materials.pairs[i];
    pair.a.youngs_modulus = 5e6 * static_cast<double>(1 + i);
    pair.a.poissons_ratio = 0.3;
    pair.b = pair.a;
    pair.occurs = true;
    pair.restitution = 0.3 + 0.1 * static_cast<double>(i);
    pair.friction = 0.0;
    pair.parameters.set("stiffness", 1e4 * static_cast<double>(1 + i));
    pair.parameters.set("exponent", 1.0 + 0.4 * static_cast<double>(i));
    pair.parameters.set("reference_speed", 1.0);
    pair.parameters.set("relaxation_time", 1e-5);
    pair.parameters.set("work_of_adhesion", 2.0 * static_cast<double>(i));
  }
  return smooth_law(setup);
}

DashpotLoss<double> loss_of(const ContactKinematics& at, double push, double push_before) {
  return dashpot_loss(at.step, push, push_before, at.approach_velocity, at.middle_velocity);
}

/// A full tile of random contacts, of which some are held beyond touch, against one at a time.
template <int n>
void check_tile(const SmoothLaw& law, bool one_row) {
  const auto tile = std::make_unique<ContactTile<n>>();
  ContactTile<n>& t = *tile;
  t.count = t.most;
  t.groups = t.size;
  std::mt19937_64 random(n);
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  constexpr double dt = 1e-5, lag = 0.5 * dt;
  alignas(64) double before[ContactTile<n>::most], now[ContactTile<n>::most] = {};
  std::vector<ContactKinematics> contacts(t.most);
  for (std::size_t k = 0; k < t.most; ++k) {
    auto& c = t.group[k / n];
    const bool held = k % 2 == 1;
    t.overlap[k] = law.holds && held ? between(-2e-5, 5e-4) : between(1e-7, 5e-4);
    t.row[k] = static_cast<std::uint32_t>(k % 4);
    c.approach[k % n] = between(-3, 3);
    c.inverse_mass[k % n] = between(1e2, 1e4);
    c.radius[k % n] = between(1e-3, 5e-3);
    c.middle[k % n] = between(-3, 3);
    c.area[k % n] = between(1e-7, 1e-5);
    before[k] = !held ? 0.0 : law.holds ? between(0.02, 0.04) : between(1e-4, 6e-4);
    contacts[k] = {t.overlap[k], c.approach[k % n], 1.0 / c.inverse_mass[k % n], c.radius[k % n]};
    contacts[k].area = c.area[k % n];
    contacts[k].middle_velocity = c.middle[k % n];
    contacts[k].step = {dt, lag * c.inverse_mass[k % n]};
  }
  const PairRow* rows = law.rows.data();
  const Passes passes = law.passes();
  double push_before[ContactTile<n>::most], push[ContactTile<n>::most];
  for (double& force : push_before) force = between(-1, 1);
  double* const pushes = law.needs.push ? push : nullptr;
  passes.normal({{tile.get(), &passes, rows, one_row, dt}, before, now, push_before, pushes, lag, true});
  for (std::size_t k = 0; k < t.most; ++k) {
    const auto& c = t.group[k / n];
    const double* numbers = law.numbers.data() + (one_row ? 0 : t.row[k]) * law.per_pair;
    double next = 0.0;
    const NormalResponse r = law.normal().one(numbers, contacts[k], &before[k], &next, law.locates ? &dt : nullptr);
    INFO("contact " << k << " on " << n << " lanes, overlap " << contacts[k].overlap);
    CHECK(c.force[k % n] == r.force);
    CHECK(c.normal_stiffness[k % n] == r.stiffness);
    CHECK(c.grip[k % n] == std::max(0.0, r.force + r.adhesion));
    CHECK(c.elastic[k % n] == r.energy);
    const double force = law.needs.push ? r.force - r.elastic_force : 0.0;
    const DashpotLoss<double> loss = loss_of(contacts[k], force, law.needs.push ? push_before[k] : 0.0);
    CHECK((c.viscous[k % n] == loss.power && c.late[k % n] == loss.late));
    if (law.needs.push) CHECK(push[k] == force);
    if (!law.needs.normal) continue;
    CHECK((now[k] == next && c.lost[k % n] == r.lost));
  }
}

}  // namespace

TEST_CASE("a normal law answers a tile with the bits of one contact at a time", "[laws][tile]") {
  const bool locate = GENERATE(false, true);
  for (const Entry& entry : law_entries(NormalLaws{})) {
    INFO(entry.name << (locate ? ", located" : ""));
    const SmoothLaw law = law_with(entry.name, locate);
    for (const bool one_row : {true, false}) {
      limit_target(Target::baseline);
      check_tile<2>(law, one_row);
      limit_target(Target::avx2);
      if (target() == Target::avx2) check_tile<4>(law, one_row);
      limit_target(Target::avx512);
      if (target() == Target::avx512) check_tile<8>(law, one_row);
    }
  }
}

TEST_CASE("the cube root of laws is that of the library over eighty decades", "[laws][tile]") {
  CHECK(cube_root(0.0) == 0.0);
  for (double x = 1e-60; x < 1e20; x *= 1.37) CHECK(cube_root(x) == Approx(std::cbrt(x)).epsilon(1e-15));
}
