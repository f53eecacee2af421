/// @file impact.h  Laws of impact, chosen by `impact`. An impact is an approach above the threshold, at the middle of
/// the step: on the velocities v_k + a dt/2.
///
///   energetic   (the default) gains no energy. One contact alone (single_impact.cpp) is struck before the problem of
///               the step: one of a sphere on a body that is not free at its own time, as under `sequential`, one whose
///               friction couples normal and slip by Stronge's energetic coefficient (energetic_impact.h). All others:
///               u_N+ >= -e u_N- in the problem of the step, e reduced where friction would give energy back
///               (impact_balance.h).
///               Limits: the solver's tolerance times the energy; with friction, a slip that turns round within a step
///               at a contact that opens slowly gives back less than 1e-3 m (|g| dt)^2.
///   newton      the same without regard to energy: gains some with friction and rotation (Kane's paradox), where e
///               differs from contact to contact, and where a contact that opens is struck from elsewhere.
///
/// The next two act once in a step in which some contact closes faster than the threshold (and any has e > 0); the
/// other half of gravity and all lasting contact follow in the problem of the step, without restitution.
///   poisson     (Pfeiffer and Glocker 1996, ch. 8) Compression: the contacts that close take the impulses r_c that
///               stop them. Expansion: each gives back e r_cN along its normal, more only where it would close again,
///               with friction |r_T| <= mu r_N: u+ = W r + u_c, 0 <= u+_N orthogonal to r_N - e r_cN >= 0. One contact
///               without friction: Newton's law. In chains the shock goes through everything that touches. The
///               expansion is solved by sweeps in sequence: accurate where shocks are sparse, slow to converge in tall
///               stacks. Gains energy as Newton's does.
///   sequential  one contact at a time in the order of closing within the drift to the next middle (event-driven;
///               Ivanov 1995): u_N+ = -e u_N-, friction on the exact cone, then the velocities of its neighbours are
///               new. Impacts are located: with gravity until then in u_N-, and a body struck at time t after the
///               middle is put where it would be, -t dv from where the step takes it: a ball falling freely bounces
///               exactly, at any dt. Its place at the end of the step is on the parabola after the impact, even where
///               that is still to come: below the floor by up to dt/2 times its speed. Newton's cradle sends the last
///               ball off; Galperin's billiard counts pi. Ties go by contact order, so that a ball that strikes two
///               touching ones at once is not treated symmetrically. With e < 1 chains of ever smaller impacts end at
///               the threshold; those left after `most_events` per contact are stopped without rebound and counted in
///               `left`. Gains energy with friction and rotation as Newton's does, and O(dt) by putting bodies that
///               turn where they would be.
#pragma once
#include <optional>
#include <string>

#include "laws/nonsmooth/impact_balance.h"
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

enum class ImpactLaw { energetic, newton, poisson, sequential };
/// Of the parameter `impact`, energetic if it is absent.
ImpactLaw impact_law(const Parameters& parameters);

class Impacts {
 public:
  explicit Impacts(ImpactLaw law) : law_(law) {}
  ImpactLaw law() const { return law_; }
  bool separate() const { return law_ == ImpactLaw::poisson || law_ == ImpactLaw::sequential; }

  /// What the impacts see of a step.
  struct Step {
    std::span<const double> gap;          ///< [m]
    std::span<const double> restitution;  ///< e of each contact
    const BodyVelocities& before;         ///< v_k
    double threshold;                     ///< slower approaches do not bounce [m/s]
    double dt;                            ///< [s]
    bool locates = true;  ///< impacts may put bodies where they would be; not with solvers that move bodies themselves
  };
  /// Adds the impulses of the impacts to problem.free. False, and nothing done, in a step without impact.
  bool apply(ContactProblem& problem, const Step& step, ContactSolver& solver);

  /// Law `energetic`: strikes the contacts that are alone, adds their impulses to problem.free and takes their bounce
  /// out of the problem and of `balance`. False where there is none.
  bool strike_single(ContactProblem& problem, const Step& step, ImpactBalance& balance);

  const Impulses& impulses() const { return r_; }
  /// Law `energetic`: what the last strikes changed velocities by.
  const BodyVelocities& struck() const { return struck_; }
  /// What takes the bodies to where impacts at their own times have them at the next detection [m], [rad].
  const BodyVelocities& displacement() const { return shift_; }
  std::uint64_t events() const {
    return events_;
  }                                             ///< impacts so far: contacts that closed (poisson), events (sequential)
  std::uint64_t left() const { return left_; }  ///< stopped without rebound, as a step had too many

 private:
  bool find(const ContactProblem& problem, const Step& step);
  void poisson(const Step& step, ContactSolver& solver);
  void expand(const Step& step);
  void sequential(const Step& step);

  /// Of one contact alone.
  struct Strike {
    std::size_t contact;
    Vec3 impulse;  ///< in its frame [N s]
    double time;   ///< from the middle of the step [s]
  };
  bool is_single(const ContactProblem& problem, std::size_t i, const Step& step) const;
  Strike strike_central(ContactProblem& problem, std::size_t i, const Step& step, const Bounce& bounce) const;
  std::optional<Strike> strike(ContactProblem& problem, std::size_t i, const Step& step, const Bounce& bounce) const;

  ImpactLaw law_;
  ContactProblem impact_;  ///< of the middle of the step; contacts that stay open have W_ii = 0
  Impulses r_, r_c_;
  BodyVelocities shift_;  ///< of positions, by impacts after the middle [m], [rad]
  BodyVelocities struck_;
  std::vector<double> approach_;            ///< at the middle [m/s]
  std::vector<double> pull_;                ///< what half a step of gravity adds to it [m/s]
  double threshold_ = 0.0, fastest_ = 0.0;  ///< of this step [m/s]
  std::uint64_t events_ = 0, left_ = 0;
};

}  // namespace epafi
