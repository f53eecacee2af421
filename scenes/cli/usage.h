/// @file usage.h  What the program answers to a command line that it cannot follow. Only main.cpp sees it: the parser's
/// headers take seconds to compile.
#pragma once
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <string>
#include <vector>

#include "engine/units/nearest.h"

namespace epafi {

template <class Number>
bool is_number(const std::string& text, Number least, Number most) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && least <= value && value <= most;
}

/// A whole number of an option in [least, most].
inline CLI::Validator whole_number(long long least, long long most = 1'000'000'000) {
  const auto answer = [=](const std::string& text) {
    return is_number(text, least, most) ? std::string()
                                        : fmt::format("'{}' is no whole number from {} to {}", text, least, most);
  };
  return {answer, ""};
}

/// The name of a file or folder: any text but none.
inline CLI::Validator file_name() {
  return {[](const std::string& text) { return text.empty() ? std::string("the name of a file is missing") : ""; }, ""};
}

/// A number of an option that is `least` or more.
inline CLI::Validator at_least(double least) {
  const auto answer = [=](const std::string& text) {
    return is_number(text, least, 1e300) ? std::string() : fmt::format("'{}' is no number of at least {}", text, least);
  };
  return {answer, ""};
}

inline std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

inline bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

inline std::string hint(const std::string& word, const std::vector<std::string>& names) {
  const auto close = nearest(word, names);
  return close ? "did you mean '" + *close + "'? " : "";
}

/// Text of `epafi help` and `epafi help COMMAND`; empty for other commands.
inline std::string asked_help(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || std::string(argv[1]) != "help") return {};
  const bool of_one = argc > 2 && holds(command_names(app), argv[2]);
  return of_one ? app.get_subcommand(std::string(argv[2]))->help(app.get_name()) : app.help();
}

/// Says what is wrong with the name of a command; empty if there is a command of this name, or none was given.
inline std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  const std::vector<std::string> names = command_names(app);
  if (argc < 2 || argv[1][0] == '-' || holds(names, argv[1])) return {};
  return fmt::format("error: unknown command '{}'; {}there are: {}\n", argv[1], hint(argv[1], names),
                     fmt::join(names, ", "));
}

/// The same for the options that the command was given.
inline std::string unknown_option(const CLI::App& app, int argc, char** argv) {
  if (argc < 3 || !holds(command_names(app), argv[1])) return {};
  const CLI::App& command = *app.get_subcommand(std::string(argv[1]));
  std::vector<std::string> names, letters;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& letter : option->get_snames()) letters.push_back("-" + letter);
  }
  for (int k = 2; k < argc; ++k) {
    const std::string word = std::string(argv[k]).substr(0, std::string(argv[k]).find('='));
    if (word.size() < 2 || word[0] != '-' || is_number(word, -1e300, 1e300)) continue;
    if (holds(names, word) || (word[1] != '-' && holds(letters, word.substr(0, 2)))) continue;
    names.insert(names.end(), letters.begin(), letters.end());
    return fmt::format("error: unknown option '{}' of epafi {}; {}it takes: {}\n", word, argv[1], hint(word, names),
                       fmt::join(names, ", "));
  }
  return {};
}

}  // namespace epafi
