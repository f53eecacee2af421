#include "laws/smooth/passes/choose_passes.h"

#include <cstring>

#include "laws/smooth/choose_law.h"

namespace epafi {

namespace {

template <class Law>
constexpr bool fits_tiles = sizeof(typename Law::Parameters) <= sizeof(Lanes) && !Law::needs.area &&
                            (!RemembersNormal<Law> || sizeof(NormalState<Law>) == sizeof(double));

/// Of every pair that occurs; fill(row, pair).
template <class Fill>
void fill_rows(const MaterialTable& table, std::vector<PairRow>& rows, const Fill& fill) {
  rows.resize(table.pairs.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (table.pairs[i].occurs) fill(rows[i], table.pairs[i]);
}

template <class Law>
void fill_normal(const SmoothSetup& setup, TileLaws& laws) {
  fill_rows(setup.materials, laws.rows, [&](PairRow& row, const MaterialPair& pair) {
    const typename Law::Parameters p = Law::parameters(pair);
    std::memcpy(&row.normal, &p, sizeof p);
    laws.damped = laws.damped || Law::is_damped(p);
  });
  laws.normal = normal_evaluation<Loop<Law>>;
  laws.needs.normal = RemembersNormal<Law>;
  laws.holds_on = requires(const NormalState<Law>& s) { Law::holds(s); };
}

template <class Law>
void fill_tangential(const SmoothSetup& setup, TileLaws& laws) {
  laws.needs.friction = Law::is_present;
  laws.needs.bristles = std::same_as<typename Law::Memory, Bristles>;
  if constexpr (Law::is_present)
    fill_rows(setup.materials, laws.rows, [&](PairRow& row, const MaterialPair& pair) {
      const typename Law::Parameters p = Law::parameters(pair);
      static_assert(sizeof p <= sizeof(Lanes));
      std::memcpy(&row.tangential, &p, sizeof p);
      if constexpr (WithDashpot<Law>) laws.needs.rolling = laws.needs.rolling || p.damping > 0.0;
    });
}

template <class Law>
void fill_rolling(const SmoothSetup& setup, TileLaws& laws) {
  if constexpr (Law::is_present) {
    laws.needs.rolling = true;
    fill_rows(setup.materials, laws.rows, [&](PairRow& row, const MaterialPair& pair) {
      const AnyRolling::Parameters p = Law::parameters(pair);
      row.rolling = Lanes{p.friction, p.damping, 0.0, 0.0};
      laws.rolling = p.type;
    });
  }
}

}  // namespace

Passes TileLaws::passes() const {
  Passes out;
  out.normal = normal().tile;
  out.type = rolling;
  out.needs = needs;
  out.locates = locates;
  if (needs.friction) out.tangential = needs.bristles ? bristle_pass() : coulomb_pass();
  if (needs.rolling) out.rolling = rolling_pass();
  return out;
}

std::string without_tiles(const SmoothSetup& setup) {
  const SmoothParts parts = smooth_parts(setup);
  const bool fits = with_law(NormalLaws{}, parts.normal, [](auto n) { return fits_tiles<typename decltype(n)::type>; });
  return fits ? "" : "no tiles of law '" + parts.normal + "'";
}

TileLaws tile_laws(const SmoothSetup& setup) {
  const SmoothParts parts = smooth_parts(setup);
  TileLaws laws;
  laws.materials = static_cast<std::uint32_t>(setup.materials.materials);
  laws.locates = parts.locate;
  with_law(NormalLaws{}, parts.normal, [&](auto n) {
    if constexpr (fits_tiles<typename decltype(n)::type>) fill_normal<typename decltype(n)::type>(setup, laws);
  });
  with_law(TangentialLaws{}, parts.tangential,
           [&](auto t) { fill_tangential<typename decltype(t)::type>(setup, laws); });
  with_law(RollingLaws{}, parts.rolling, [&](auto r) { fill_rolling<typename decltype(r)::type>(setup, laws); });
  laws.damped = laws.damped || laws.needs.rolling || laws.locates;
  return laws;
}

}  // namespace epafi
