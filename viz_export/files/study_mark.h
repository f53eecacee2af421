/// @file study_mark.h  study.json in the folder of a chart, limits or sweep: the command that fills it, written at its
/// start, so that a page of the folder says what is still to come.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace epafi {

struct StudyMark {
  std::string kind;       ///< "chart", "limits", "sweep"
  std::string command;    ///< as typed: "epafi sweep scene.toml"
  std::size_t cases = 0;  ///< it has in all; 0: not known before its end
  bool finished = false;  ///< not said of a sweep, whose cases may be run one by one
};

/// Throws FileError where it cannot be written.
void write_study_mark(const std::filesystem::path& folder, const StudyMark& mark);
/// Reads the mark of a study; none where the file is missing or unreadable.
[[nodiscard]] std::optional<StudyMark> read_study_mark(const std::filesystem::path& folder);

/// Text on missing cases; empty if none is missing.
[[nodiscard]] std::string unfinished_text(const StudyMark& mark, std::size_t ended);

}  // namespace epafi
