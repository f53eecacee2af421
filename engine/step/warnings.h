/// @file warnings.h  What went wrong in a run without ending it: one entry a kind, with its first step, how often it
/// came and the worst value. Shown in the progress line, summary.json (`warnings`), the report; `run --strict` exits
/// with 1.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/state/state_visitor.h"

namespace epafi {

struct Warning {
  std::string kind;              ///< one word: "energy", "unconverged"
  std::string text;              ///< of the worst time, without step and body
  std::uint64_t first_step = 0;  ///< when it came first
  double first_time = 0.0;       ///< [s]
  std::uint64_t worst_step = 0;  ///< of `value`
  double value = 0.0;            ///< the largest so far
  std::uint64_t times = 0;       ///< how often it came
  std::optional<BodyId> body{};  ///< of the worst time
};

class Warnings {
 public:
  /// Once more of this kind; the text of the largest value stands.
  void add(const Warning& now);
  bool empty() const { return all_.empty(); }
  const std::vector<Warning>& all() const { return all_; }
  void visit(StateVisitor& visitor);

 private:
  std::vector<Warning> all_;  ///< in the order of their first steps
};

/// One line: text, body's name where it is given, first step, how often, worst step.
std::string warning_line(const Warning& warning, const std::string& body_name = {});

}  // namespace epafi
