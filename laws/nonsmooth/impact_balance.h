/// @file impact_balance.h  Energy of simultaneous impacts. Newton's law u_N+ = -e u_N- alone can create energy: if
/// normal impulses reverse the slip, friction, which opposes the final slip, does positive work (Kane's paradox). Here
/// the rebound of an island of bodies is s e u_N- with the largest s in [0, 1] that satisfies
///   sum of -r.(u- + u+)/2  >=  sum over contacts that bounce of (1 - e)/2 r_N |u_N-|,
/// the loss of the same impulses without friction. s = 1 if all contacts have no friction and one e. s = 0 never
/// creates energy: then r.u+ <= 0 and the kinetic energy changes by r.u+ - r.W r/2. Since solvers stop at a tolerance,
/// a remaining gain is removed by scaling down the impulses of the island.
#pragma once
#include <vector>

#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

/// A contact that bounces: u_N >= -(restitution middle - half) at the end of the step.
struct Bounce {
  double middle = 0.0;       ///< speed of approach at the middle of the step [m/s]; 0: it does not bounce
  double half = 0.0;         ///< change of that speed by half a step of gravity [m/s]
  double restitution = 0.0;  ///< e of the material pair
};

class ImpactBalance {
 public:
  /// A solve: its problem, impulses, and relative velocities before and after [m/s].
  struct Solved {
    const ContactProblem& problem;
    const Impulses& r;
    const std::vector<Vec3>& before;
    const std::vector<Vec3>& after;
  };

  /// Begins a step with `contacts` contacts, none of which bounces.
  void begin(std::size_t contacts);
  void note(std::size_t i, const Bounce& bounce) { bounces_[i] = bounce; }
  void drop(std::size_t i) { bounces_[i] = {}; }
  const Bounce& bounce(std::size_t i) const { return bounces_[i]; }
  bool any() const;

  /// After the first solve with s = 1: the islands.
  void find_islands(const Solved& solved);
  /// After every solve. True: some s has changed, and w of `problem` with it; solve again.
  bool tighten(const Solved& solved, double tolerance, ContactProblem& problem);
  /// Takes out of r what is left of a gain; true where there was one.
  bool clip(const Solved& solved, Impulses& r);

 private:
  /// Energies of the bodies that impulses join [J].
  struct Island {
    double lost = 0.0;      ///< by all contacts
    double owed = 0.0;      ///< (1 - e)/2 r_N |u_N-| of those that bounce
    double struck = 0.0;    ///< r_N |u_N-| of those that bounce
    double response = 0.0;  ///< r.W r
    double e = 0.0;         ///< the largest
    double excess() const { return struck > 0.0 ? (lost - owed) / struck : 0.0; }
  };
  /// The search for s: excess(low) >= 0 > excess(high), as far as they are known.
  struct Search {
    double s = 1.0, low = 0.0, high = 1.0, at_low = -1.0, at_high = 0.0;
    int solves = 0;
    bool settled = false;
  };
  std::uint32_t root(std::uint32_t slot);
  std::uint32_t root_of(const ContactProblem& problem, std::size_t i);
  void measure(const Solved& solved);
  void advance(Search& search, const Island& island, double tolerance) const;

  std::vector<Bounce> bounces_;
  std::vector<std::uint32_t> parent_;  ///< of bodies, by slot
  std::vector<Island> islands_;        ///< by the slot of their root
  std::vector<Search> search_;
};

}  // namespace epafi
