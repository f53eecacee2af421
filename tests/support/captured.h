/// @file captured.h  What a command of the program prints and returns, run inside a test.
#pragma once
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <string>

#include "tests/viz_export/temporary_folder.h"

namespace epafi {

struct Captured {
  int code;
  std::string out, err;
};

/// Runs the command with stdout and stderr going to files.
inline Captured captured(const std::function<int()>& command) {
  const TemporaryFolder folder;
  const auto redirect = [&](std::FILE* stream, const char* name) {
    std::fflush(stream);
    const int kept = ::dup(::fileno(stream)),
              file = ::open((folder / name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(file, ::fileno(stream));
    ::close(file);
    return kept;
  };
  const auto restore = [](std::FILE* stream, int kept) {
    std::fflush(stream);
    ::dup2(kept, ::fileno(stream));
    ::close(kept);
  };
  const auto text = [&](const char* name) {
    std::ifstream in(folder / name);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const int out = redirect(stdout, "out"), err = redirect(stderr, "err");
  int code = 0;
  try {
    code = command();
  } catch (...) {  // what is said of it must be seen
    restore(stdout, out);
    restore(stderr, err);
    throw;
  }
  restore(stdout, out);
  restore(stderr, err);
  return {code, text("out"), text("err")};
}

}  // namespace epafi
