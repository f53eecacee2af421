/// @file team.h  Rank 0 leads: it has the whole simulation and orders all tasks and the end. All decisions are made
/// there, so that ranks cannot differ.
#pragma once
#include "engine/ranks/rank_team.h"
#include "ranks/mpi_messages.h"

namespace epafi {

class MpiTeam final : public RankTeam {
 public:
  int count() const override;
  int number() const override;
  void lead(Simulation& whole, std::shared_ptr<Simulation> part, PartSetup setup) override;
  void announce(const std::string& text) override;
  RankMessages* helpers() override { return helped_ ? &messages_ : nullptr; }
  std::optional<RankFigures> figures() override;
  Followed follow(Simulation& part, PartSetup setup) override;

  /// Called by every rank when its command has ended with this code. Returns false if the others cannot be informed,
  /// because this rank failed within a common task: they must be aborted.
  bool end(int code);
  /// The code that the run ends with, after `end`.
  int code() const { return code_; }

 private:
  std::function<RankFigures()> figures_;
  bool agreed_ = false;     ///< all have begun with this simulation, or said that they cannot
  bool following_ = false;  ///< rank 0 has not ended yet
  bool busy_ = false;       ///< rank 0: within something that all do together
  int code_ = 0;
  bool helped_ = false;  ///< the others wait for problems of this rank
  MpiMessages messages_{busy_};
};

}  // namespace epafi
