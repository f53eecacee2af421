/// @file smooth_law.h  The law of a scene as the loops over contacts use it: parameters by pair of materials, and a
/// function for each part, resolved once from names or types. The loops over spheres and over all other contacts
/// (laws/smooth/smooth_contact.h) call a part once per tile of contacts, so code size is the sum of the parts, not the
/// product.
#pragma once
#include <vector>

#include "laws/smooth/choose_law.h"
#include "laws/smooth/contact_edge.h"
#include "laws/smooth/fused/sphere_springs.h"
#include "laws/smooth/make_smooth_contact.h"

namespace epafi {

struct NormalCall;
struct TangentialCall;
struct RollingCall;
struct Passes;

/// Parameters of a pair of materials for tiles: the numbers of the parts' Parameters; of rolling: friction, damping.
struct alignas(32) PairRow {  // an aligned load of a part; GCC takes 16 for a vector type of a template
  static constexpr std::size_t most = 4;
  Lanes normal{}, tangential{}, rolling{};
};

/// Functions of a normal law: for the contacts of a tile, and for one contact.
struct NormalEvaluation {
  void (*tile)(const NormalCall&) = nullptr;  ///< null: the law has no lanes
  /// numbers: of the pair; before, now: what the law remembers; dt: where start and end of contacts are located.
  NormalResponse (*one)(const double* numbers, const ContactKinematics&, const double* before, double* now,
                        const double* dt_if_located) = nullptr;
};
/// Compiled in laws/smooth/passes/normal_laws.cpp, a line for each Loop<Law>; for the widest lanes of now.
template <class Law>
NormalEvaluation normal_evaluation();

/// Functions of a friction law for one contact; numbers: PairRow::tangential.
struct FrictionEvaluation {
  FrictionResponse (*pull)(const Lanes& numbers, const SlipStep&, const double* before, double* now) = nullptr;
  double (*energy)(const double* memory) = nullptr;
  void (*exchange)(double* memory) = nullptr;  ///< bodies A and B
  std::size_t memory = 0;                      ///< numbers that it remembers of a contact
  bool is_spring = false;                      ///< CoulombSpring with its parameters, which has lanes: TileSpring
};

void (*coulomb_pass())(const TangentialCall&);
void (*rolling_pass())(const RollingCall&);
void (*pointwise_normal())(const NormalCall&);
void (*pointwise_friction())(const TangentialCall&);

struct SmoothLaw {
  NormalEvaluation (*normal)() = nullptr;
  bool (*holds)(const double* state) = nullptr;  ///< a contact beyond touch; null: none does
  std::vector<double> numbers;                   ///< of the normal law, of the first pair, the second and so on
  std::size_t per_pair = 0, state = 0;           ///< numbers of a pair, and those that it remembers of a contact
  FrictionEvaluation friction;
  std::vector<PairRow> rows;  ///< as MaterialTable::pairs
  std::uint32_t materials = 1;
  bool damped = false;  ///< velocities at the time of the detection are wanted
  SphereNeeds needs;
  Needs contact;  ///< data of a contact that the parts need
  bool rolls = false;
  AnyRolling::Type rolling = AnyRolling::Type::spring;
  bool locates = false;

  bool remembers() const { return needs.remembers(); }
  Passes passes() const;
};

/// Reason why a set-up cannot use tiles of spheres; empty: it can.
std::string without_tiles(const SmoothSetup& setup);
SmoothLaw smooth_law(const SmoothSetup& setup);

/// Contacts of spheres have no area and remember one number.
template <class Law>
inline constexpr bool fits_spheres =
    !Law::needs.area && (!RemembersNormal<Law> || sizeof(NormalState<Law>) == sizeof(double));

/// Parameters, or what a law remembers, from its numbers one behind the other.
template <class T>
T from_numbers(const void* numbers) {
  T out;
  std::memcpy(static_cast<void*>(&out), numbers, sizeof out);
  return out;
}

/// Response of one contact.
template <class Law>
NormalResponse respond_to(const double* numbers, const ContactKinematics& c, const double* before, double* now,
                          const double* dt_if_located) {
  const auto p = from_numbers<typename Law::Parameters>(numbers);
  NormalState<Law> old, next;
  if constexpr (RemembersNormal<Law>) old = from_numbers<NormalState<Law>>(before);
  NormalResponse out = respond<Law>(p, c, old, next);
  if constexpr (RemembersNormal<Law>) std::memcpy(now, &next, sizeof next);
  if constexpr (PowerParts<Law>)
    if (dt_if_located != nullptr) out = weigh_edge<Law>(p, c, *dt_if_located, out);
  return out;
}

/// fill(number of the pair, pair) for every pair that occurs.
template <class Fill>
void each_pair(const MaterialTable& table, const Fill& fill) {
  for (std::size_t i = 0; i < table.pairs.size(); ++i)
    if (table.pairs[i].occurs) fill(i, table.pairs[i]);
}

template <class Law>
void take_normal(const MaterialTable& table, SmoothLaw& law) {
  using Parameters = typename Law::Parameters;
  constexpr std::size_t size = sizeof(double);
  static_assert(sizeof(Parameters) % size == 0, "parameters of a law are numbers");
  law.per_pair = sizeof(Parameters) / size;
  law.numbers.resize(law.per_pair * table.pairs.size());
  each_pair(table, [&](std::size_t i, const MaterialPair& pair) {
    const Parameters p = Law::parameters(pair);
    std::memcpy(law.numbers.data() + i * law.per_pair, &p, sizeof p);
    if constexpr (LaneLaw<Law>) {
      static_assert(sizeof p <= sizeof(Lanes), "a law with lanes has at most four numbers");
      std::memcpy(&law.rows[i].normal, &p, sizeof p);
    }
    law.needs.push = law.needs.push || Law::is_damped(p);
  });
  law.damped = law.needs.push;
  if constexpr (RemembersNormal<Law>) {
    static_assert(sizeof(NormalState<Law>) % size == 0, "a law remembers numbers, all 0 of a contact that begins");
    law.state = sizeof(NormalState<Law>) / size;
    law.needs.normal = true;
  }
  if constexpr (requires(const NormalState<Law>& s) { Law::holds(s); })
    law.holds = [](const double* state) { return Law::holds(from_numbers<NormalState<Law>>(state)); };
  law.contact = law.contact | Law::needs;
}

template <class Law>
FrictionEvaluation friction_evaluation() {
  using Memory = typename Law::Memory;
  using Parameters = typename Law::Parameters;
  static_assert(sizeof(Memory) % sizeof(double) == 0 && alignof(Memory) == alignof(double));
  FrictionEvaluation out;
  out.memory = sizeof(Memory) / sizeof(double);
  out.is_spring = std::same_as<Law, CoulombSpring>;
  out.pull = [](const Lanes& numbers, const SlipStep& step, const double* before, double* now) {
    return Law::pull(from_numbers<Parameters>(&numbers), step, *reinterpret_cast<const Memory*>(before),
                     *reinterpret_cast<Memory*>(now));
  };
  out.energy = [](const double* memory) { return energy_of(*reinterpret_cast<const Memory*>(memory)); };
  out.exchange = [](double* memory) { exchange(*reinterpret_cast<Memory*>(memory)); };
  return out;
}

template <class Law>
void take_tangential(const MaterialTable& table, SmoothLaw& law) {
  law.contact = law.contact | Law::needs;
  law.needs.friction = Law::is_present;
  law.needs.bristles = std::same_as<typename Law::Memory, Bristles>;
  if constexpr (Law::is_present) {
    using Parameters = typename Law::Parameters;
    static_assert(sizeof(Parameters) <= sizeof(Lanes), "friction has at most four numbers");
    static_assert(!WithDashpot<Law> || std::same_as<Parameters, CoulombSpring::Parameters>);
    law.friction = friction_evaluation<Loop<Law>>();
    each_pair(table, [&](std::size_t i, const MaterialPair& pair) {
      const Parameters p = Law::parameters(pair);
      std::memcpy(&law.rows[i].tangential, &p, sizeof p);
      if constexpr (WithDashpot<Law>) law.needs.dashpots = law.needs.dashpots || p.damping > 0.0;
    });
  }
}

template <class Law>
void take_rolling(const MaterialTable& table, SmoothLaw& law) {
  law.contact = law.contact | Law::needs;
  if constexpr (Law::is_present) {
    law.needs.rolling = law.rolls = true;
    each_pair(table, [&](std::size_t i, const MaterialPair& pair) {
      const AnyRolling::Parameters p = Law::parameters(pair);
      law.rows[i].rolling = Lanes{p.friction, p.damping, 0.0, 0.0};
      law.rolling = p.type;
    });
  }
}

/// From types: laws of outside, without lanes.
template <NormalLaw Normal, TangentialLaw Tangential, RollingLaw Rolling>
SmoothLaw smooth_law(const MaterialTable& table) {
  SmoothLaw law;
  law.materials = static_cast<std::uint32_t>(table.materials);
  law.rows.resize(table.pairs.size());
  law.normal = [] { return NormalEvaluation{nullptr, respond_to<Normal>}; };
  take_normal<Normal>(table, law);
  take_tangential<Tangential>(table, law);
  take_rolling<Rolling>(table, law);
  law.damped = law.damped || law.needs.damps_slip();
  return law;
}

}  // namespace epafi
