/// @file rank_team.h  The processes of a run: the interface for floors without MPI. Process 0 leads: it has the whole
/// simulation and all files; the others follow.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/ranks/rank_messages.h"
#include "engine/ranks/remote_steps.h"

namespace epafi {

/// Data of the scene for distributing bodies.
struct PartSetup {
  /// Processes share whole steps, each with its bodies, or only the search for contacts of process 0.
  enum class Shares { steps, contacts };
  Shares shares = Shares::steps;
  double reach = 0.0;                                 ///< contacts begin at this gap [m]
  std::function<double(std::uint32_t shape)> radius;  ///< bounding radius of World::shape [m]
  std::function<bool(std::uint32_t shape)> is_clump;  ///< of World::shape
  /// Bodies on which a contact depends: 1: its two bodies; 3: also those that touch them, and those that touch these.
  int rings = 1;
  /// stiffness_bound (engine/step/stiffest_mode.h) of a part's contacts for a step dt [s]; empty: not needed.
  std::function<double(const World&, const ContactPieces&, double dt)> stiffness{};
  bool deforms = false;  ///< the periodic cell, before each step
  /// Pairs of bodies that interact at any distance: ends of springs.
  std::vector<std::pair<BodyId, BodyId>> tied{};
  std::function<void(RankMessages&)> help{};  ///< with what process 0 solves (RankMessages::together)
  bool only_spheres = false;                  ///< among half-spaces that stand still
};

class RankTeam {
 public:
  virtual ~RankTeam() = default;
  virtual int count() const = 0;
  virtual int number() const = 0;
  /// Called by process 0: from now on all processes share the work of the simulation. part: the same scene; its bodies
  /// are discarded. FileError if another process cannot begin. May be called again after `announce`.
  virtual void lead(Simulation& whole, std::shared_ptr<Simulation> part, PartSetup setup) = 0;
  /// Called by process 0 when this simulation is done and its state gathered; `lead` follows with another one, which
  /// this text describes to the others.
  virtual void announce(const std::string& text) = 0;
  /// Called by process 0: messages to the others, which wait for work on its problems; null if they do not.
  virtual RankMessages* helpers() = 0;
  /// Statistics of the run, at process 0.
  virtual std::optional<RankFigures> figures() = 0;
  /// Called by all others: returns when process 0 has ended, or has announced another simulation.
  struct Followed {
    int code = 0;             ///< exit code of the run
    std::string announced{};  ///< empty: number 0 has ended
  };
  virtual Followed follow(Simulation& part, PartSetup setup) = 0;

  /// The team of this program; null for a single process.
  static RankTeam* of_program() { return of_program_; }
  static void set_of_program(RankTeam* team) { of_program_ = team; }

 private:
  static inline RankTeam* of_program_ = nullptr;
};

}  // namespace epafi
