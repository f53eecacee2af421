/// @file sweep_slices.h  A problem cut for sweeps by several processes (shared_sweeps.h).
#pragma once
#include "engine/ranks/rank_messages.h"
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

/// Bodies that a process and another one sweep, by the slots of either, in one order at both.
struct Border {
  int rank;
  std::vector<std::uint32_t> bodies;
};

/// Part of the problem swept by one process, with its own numbers of bodies and contacts.
struct SweepSlice {
  ContactProblem problem;  ///< data read by sweeps
  Impulses r;
  BodyVelocities v;
  std::vector<ContactGroup> groups;          ///< colour by colour
  std::vector<std::size_t> color_begin;      ///< and one more
  std::vector<std::vector<Border>> out, in;  ///< by colour: who gets, and who sends, what it has changed

  RankMessages::Bytes packed() const;
  static SweepSlice unpacked(const RankMessages::Bytes& bytes);
};

struct SlicedProblem {
  std::vector<SweepSlice> slices;                    ///< by process
  std::vector<std::vector<std::uint32_t>> contacts;  ///< of each slice: those of the whole problem
};

/// The problem has its diagonal, and no pairs in sequence.
SlicedProblem cut_for_sweeps(const ContactProblem& problem, int ranks, const BodyVelocities& v, const Impulses& r);

}  // namespace epafi
