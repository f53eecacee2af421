/// @file background.h  A program of ours in the background of a test.
#pragma once
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace epafi::support {

/// What it says goes to a file; it ends with the test.
struct Background {
  std::filesystem::path said, number;
  Background(const std::filesystem::path& folder, const std::string& name, const std::string& arguments)
      : said(folder / (name + ".said")), number(folder / (name + ".number")) {
    const std::string command = std::string(EPAFI_BINARY_DIR) + "/bin/epafi " + arguments + " > " + said.string() +
                                " 2> /dev/null & echo $! > " + number.string();
    if (std::system(command.c_str()) != 0) throw std::runtime_error("cannot start: " + command);
  }
  ~Background() { stop(); }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  void stop() const { (void)std::system(("kill $(cat " + number.string() + ") 2> /dev/null").c_str()); }
  /// The first word that it says, within ten seconds.
  std::string word() const {
    std::string out;
    for (int k = 0; k < 200 && out.empty(); ++k) {
      ::usleep(50000);
      std::ifstream in(said);
      in >> out;
    }
    return out;
  }
};

}  // namespace epafi::support
