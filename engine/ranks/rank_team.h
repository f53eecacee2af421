/// @file rank_team.h  The processes of a run that is shared out, as the floors see them that know nothing of messages.
/// Process 0 leads: it has the whole simulation and all files; the others follow.
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

/// What a process must know of the scene to share bodies out.
struct PartSetup {
  /// Whole steps, each process with its bodies; or the search for contacts, which act on all bodies in process 0.
  enum class Shares { steps, contacts };
  Shares shares = Shares::steps;
  double reach = 0.0;                                 ///< contacts begin at this gap [m]
  std::function<double(std::uint32_t shape)> radius;  ///< bounding radius of World::shape [m]
  std::function<bool(std::uint32_t shape)> is_clump;  ///< of World::shape
  /// What a contact is decided by: 1, the two bodies; 3, what touches them, and what touches that.
  int rings = 1;
  /// Of bodies and contacts in a part, for engine/step/stiffest_mode.h; empty: it does not matter. dt [s]
  std::function<double(const World&, const ContactPieces&, double dt)> stiffness{};
  bool deforms = false;  ///< the periodic cell, before each step
  /// Bodies that act on each other wherever they are: ends of springs.
  std::vector<std::pair<BodyId, BodyId>> tied{};
  std::function<void(RankMessages&)> help{};  ///< with what process 0 solves (RankMessages::together)
  bool only_spheres = false;                  ///< among half-spaces that stand still
};

class RankTeam {
 public:
  virtual ~RankTeam() = default;
  virtual int count() const = 0;
  virtual int number() const = 0;
  /// By number 0: from now on all share in what the whole simulation does. part: of the same scene, its bodies are
  /// thrown away. FileError where another process cannot begin. Again after `announce`.
  virtual void lead(Simulation& whole, std::shared_ptr<Simulation> part, PartSetup setup) = 0;
  /// By number 0: all are done with this simulation, whose state has come home; `lead` follows with another one, of
  /// which the others know by this text.
  virtual void announce(const std::string& text) = 0;
  /// By number 0: the others wait for work with its problems; null where they do not.
  virtual RankMessages* helpers() = 0;
  /// What it has come to, by number 0; nothing where it does not lead.
  virtual std::optional<RankFigures> figures() = 0;
  /// By all others meanwhile: until number 0 has ended, or has announced another simulation, of which they follow next.
  struct Followed {
    int code = 0;             ///< exit code of the run
    std::string announced{};  ///< empty: number 0 has ended
  };
  virtual Followed follow(Simulation& part, PartSetup setup) = 0;

  /// That of this program; null where it is alone.
  static RankTeam* of_program() { return of_program_; }
  static void set_of_program(RankTeam* team) { of_program_ = team; }

 private:
  static inline RankTeam* of_program_ = nullptr;
};

}  // namespace epafi
