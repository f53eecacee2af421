/// @file manual.h  The manual page and the completion for bash, from what the command line's parser knows.
#pragma once
#include <string>
#include <vector>

namespace epafi {

struct OptionText {
  std::string names;  ///< "-o,--out", or the name of a positional
  std::string description;
  bool takes_value = false;
  bool positional = false;
};

struct CommandText {
  std::string name, description;
  std::vector<OptionText> options;
};

struct ProgramText {
  std::string description;
  std::vector<CommandText> commands;
};

[[nodiscard]] std::string manual_page(const ProgramText& program);
[[nodiscard]] std::string bash_completion(const ProgramText& program);

int command_manual(const ProgramText& program);
int command_completion(const ProgramText& program);

}  // namespace epafi
