/// @file impact.h  Impact laws, chosen by `impact`. An impact is an approach faster than the threshold in the middle of
/// the step, by the velocities v_k + a dt/2.
///
///   energetic   (default) gains no energy. A single contact is solved before the problem of the step
///               (single_impact.cpp): that of a sphere on a fixed or driven body at the time of impact, as under
///               `sequential`; one whose friction couples normal and slip by Stronge's energetic coefficient
///               (energetic_impact.h). All others: u_N+ >= -e u_N- in the problem of the step, with e reduced if
///               friction would create energy (impact_balance.h).
///               Limits: gains up to the solver's tolerance; with friction, slip that reverses within a step at a
///               slowly opening contact gains less than 1e-3 m (|g| dt)^2.
///   newton      the same without the energy limit. Gains energy with friction and rotation (Kane's paradox), if e
///               differs between contacts, and if another impact closes a contact that opens.
///
/// The next two act once in a step in which some contact closes faster than the threshold (and any has e > 0). The
/// problem of the step then has the other half of gravity and no restitution.
///   poisson     (Pfeiffer and Glocker 1996, ch. 8) Compression: impulses r_c stop the closing contacts. Expansion:
///   each
///               returns e r_cN along its normal, more only if it would close again, with friction |r_T| <= mu r_N:
///               u+ = W r + u_c, 0 <= u+_N orthogonal to r_N - e r_cN >= 0. A single contact without friction obeys
///               Newton's law; in chains the shock reaches all touching bodies. Sweeps solve the expansion: accurate
///               for few impacts, slow to converge in tall stacks. Gains energy as Newton's law does.
///   sequential  one contact at a time, in the order of closing within the drift to the next middle (event-driven;
///               Ivanov 1995): u_N+ = -e u_N-, friction on the exact cone, then new velocities of the neighbours.
///               Impacts are located: u_N- contains gravity until then, and a body that collides at time t after the
///               middle is moved by -t dv, so a ball in free fall bounces exactly at any dt. At the end of the step it
///               is on the parabola after the impact, even if the impact is later: below the floor by up to dt/2 times
///               its speed. Simultaneous impacts are ordered by contact, so a ball that hits two touching ones is not
///               treated symmetrically. With e < 1 chains of ever smaller impacts end at the threshold; those left
///               after `most_events` per contact stop without rebound and are counted in `left`. Gains energy with
///               friction and rotation as Newton's law does, and O(dt) from the positions of rotating bodies.
#pragma once
#include <optional>
#include <string>

#include "laws/nonsmooth/impact_balance.h"
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

enum class ImpactLaw { energetic, newton, poisson, sequential };
/// The law named by the parameter `impact`; energetic if it is absent.
ImpactLaw impact_law(const Parameters& parameters);

class Impacts {
 public:
  explicit Impacts(ImpactLaw law) : law_(law) {}
  ImpactLaw law() const { return law_; }
  bool separate() const { return law_ == ImpactLaw::poisson || law_ == ImpactLaw::sequential; }

  /// Input of a step.
  struct Step {
    std::span<const double> gap;          ///< [m]
    std::span<const double> restitution;  ///< e of each contact
    const BodyVelocities& before;         ///< v_k
    double threshold;                     ///< slower approaches do not bounce [m/s]
    double dt;                            ///< [s]
    bool locates = true;  ///< impacts may correct positions; not with solvers that move bodies themselves
  };
  /// Adds the impulses of the impacts to problem.free. Returns false, without changes, in a step without impact.
  bool apply(ContactProblem& problem, const Step& step, ContactSolver& solver);

  /// Law `energetic`: solves single contacts, adds their impulses to problem.free and removes their bounce from the
  /// problem and from `balance`. Returns false if there is none.
  bool strike_single(ContactProblem& problem, const Step& step, ImpactBalance& balance);

  const Impulses& impulses() const { return r_; }
  /// Law `energetic`: changes of velocity by the last single impacts [m/s], [rad/s].
  const BodyVelocities& struck() const { return struck_; }
  /// Corrections of position for impacts located within the step, due at the next detection [m], [rad].
  const BodyVelocities& displacement() const { return shift_; }
  std::uint64_t events() const {
    return events_;
  }                                             ///< impacts so far: contacts that closed (poisson), events (sequential)
  std::uint64_t left() const { return left_; }  ///< stopped without rebound because a step had too many

 private:
  bool find(const ContactProblem& problem, const Step& step);
  void poisson(const Step& step, ContactSolver& solver);
  void expand(const Step& step);
  void sequential(const Step& step);

  /// Impulse of a single contact.
  struct Strike {
    std::size_t contact;
    Vec3 impulse;  ///< in its frame [N s]
    double time;   ///< from the middle of the step [s]
  };
  bool is_single(const ContactProblem& problem, std::size_t i, const Step& step) const;
  Strike strike_central(ContactProblem& problem, std::size_t i, const Step& step, const Bounce& bounce) const;
  std::optional<Strike> strike(ContactProblem& problem, std::size_t i, const Step& step, const Bounce& bounce) const;

  ImpactLaw law_;
  ContactProblem impact_;  ///< in the middle of the step; contacts that stay open have W_ii = 0
  Impulses r_, r_c_;
  BodyVelocities shift_;  ///< displacement() [m], [rad]
  BodyVelocities struck_;
  std::vector<double> approach_;            ///< at the middle [m/s]
  std::vector<double> pull_;                ///< change of it by half a step of gravity [m/s]
  double threshold_ = 0.0, fastest_ = 0.0;  ///< of this step [m/s]
  std::uint64_t events_ = 0, left_ = 0;
};

}  // namespace epafi
