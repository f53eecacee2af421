/// @file error.h  The two kinds of error that are thrown or aborted on: a user's (SceneError) and a programmer's
/// (EPAFI_REQUIRE). Numerical trouble is neither: it is a result, see report.h.
#pragma once
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace epafi {

/// Place in a user's text; line and column count from 1, 0: unknown.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
};

/// One message about a user's input: `file:line:column: error: text`.
struct Problem {
  enum class Level { error, warning };
  Level level = Level::error;
  Place place;
  std::string text;

  std::string to_string() const {
    std::string out = place.file;
    if (place.line > 0)
      out.append(":").append(std::to_string(place.line)).append(":").append(std::to_string(place.column));
    if (!out.empty()) out.append(": ");
    return out.append(level == Level::error ? "error: " : "warning: ").append(text);
  }
};

/// Everything wrong with a user's input, collected, thrown once. Exit code 2.
class SceneError : public std::runtime_error {
 public:
  explicit SceneError(std::vector<Problem> problems)
      : std::runtime_error(join(problems)), problems_(std::move(problems)) {}
  explicit SceneError(std::string text, Place place = {})
      : SceneError(std::vector<Problem>{{Problem::Level::error, std::move(place), std::move(text)}}) {}
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  static std::string join(const std::vector<Problem>& problems) {
    std::string all;
    for (const auto& p : problems) all.append(all.empty() ? "" : "\n").append(p.to_string());
    return all;
  }
  std::vector<Problem> problems_;
};

/// A file that could not be read or written. Exit code 3.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace epafi

/// States a contract between functions; active in Debug builds and in all tests, never used for a user's input.
#ifdef EPAFI_CHECK_CONTRACTS
#define EPAFI_REQUIRE(condition, message)                                                                   \
  do {                                                                                                      \
    if (!(condition)) {                                                                                     \
      std::fprintf(stderr, "%s:%d: contract violated: %s (%s)\n", __FILE__, __LINE__, message, #condition); \
      std::abort();                                                                                         \
    }                                                                                                       \
  } while (false)
#else
#define EPAFI_REQUIRE(condition, message) ((void)0)
#endif
