#include "viz_export/files/study_mark.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/units/error.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/json_writer.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {
constexpr const char* mark_name = "study.json";
}

void write_study_mark(const std::filesystem::path& folder, const StudyMark& mark) {
  JsonWriter json;
  json.begin_object()
      .member("kind", mark.kind)
      .member("command", mark.command)
      .member("cases", static_cast<std::uint64_t>(mark.cases));
  json.member("finished", mark.finished).end_object();
  write_whole_file(folder / mark_name, {json.text() + "\n"}, true);
}

std::optional<StudyMark> read_study_mark(const std::filesystem::path& folder) {
  std::error_code none;
  if (!std::filesystem::exists(folder / mark_name, none)) return std::nullopt;
  try {
    const FlatJson json = read_json(folder / mark_name);
    StudyMark out{json.text("kind"), json.text("command")};
    out.cases = static_cast<std::size_t>(std::max(0.0, json.number("cases").value_or(0.0)));
    out.finished = json.number("finished").value_or(0.0) > 0;
    if (out.command.empty()) return std::nullopt;
    return out;
  } catch (const FileError&) {
    return std::nullopt;
  }
}

std::string unfinished_text(const StudyMark& mark, std::size_t ended) {
  const bool is_sweep = mark.kind == "sweep";
  if (mark.finished || (is_sweep && ended >= mark.cases)) return {};
  const std::string so_far = mark.cases > 0
                                 ? fmt::format("{} of its {} cases have ended", ended, mark.cases)
                                 : fmt::format("{} of its cases {} ended", ended, ended == 1 ? "has" : "have");
  const char* rest = is_sweep ? "The same command runs the others."
                     : mark.kind == "limits"
                         ? "Its table and its picture come at the end; the same command goes on."
                         : "Its table and its picture come at the end; the same command begins anew.";
  return fmt::format("`{}` has not come to its end: {}. {}", mark.command, so_far, rest);
}

}  // namespace epafi
