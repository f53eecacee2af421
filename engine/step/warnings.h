/// @file warnings.h  Troubles of a run that do not end it: one entry per kind, with the first step, the number of
/// occurrences and the worst value. They appear in the progress line, summary.json (`warnings`) and the report; `run
/// --strict` exits with 1.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/state/state_visitor.h"

namespace epafi {

struct Warning {
  std::string kind;              ///< one word: "energy", "unconverged"
  std::string text;              ///< of the worst occurrence, without step and body
  std::uint64_t first_step = 0;  ///< step of the first occurrence
  double first_time = 0.0;       ///< [s]
  std::uint64_t worst_step = 0;  ///< of `value`
  double value = 0.0;            ///< the largest so far
  std::uint64_t times = 0;       ///< number of occurrences
  std::optional<BodyId> body{};  ///< of the worst occurrence
};

class Warnings {
 public:
  /// Adds an occurrence; the text of the largest value is kept.
  void add(const Warning& now);
  bool empty() const { return all_.empty(); }
  const std::vector<Warning>& all() const { return all_; }
  void visit(StateVisitor& visitor);

 private:
  std::vector<Warning> all_;  ///< in the order of their first steps
};

/// One line: text, body's name if given, first step, occurrences, worst step.
std::string warning_line(const Warning& warning, const std::string& body_name = {});

}  // namespace epafi
