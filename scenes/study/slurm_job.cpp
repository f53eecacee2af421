#include "scenes/study/slurm_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace epafi {
namespace {

/// A word of the shell, whatever is in it.
std::string shell_word(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// What Slurm takes for a job's name without quotes.
std::string job_name(const std::string& scene) {
  std::string name = std::filesystem::path(scene).stem().string();
  const auto is_plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.'; };
  std::ranges::replace_if(
      name, [&](char c) { return !is_plain(static_cast<unsigned char>(c)); }, '_');
  return name;
}

/// Tasks that have a case to run: task t has the cases t, t + tasks, t + 2 tasks ...
std::vector<std::size_t> open_tasks(const SweepPlan& sweep, std::size_t tasks) {
  std::vector<bool> wanted(tasks, false);
  for (std::size_t k = 0; k < sweep.cases.size(); ++k)
    if (!finished_case(sweep.cases[k], sweep.hashes[k])) wanted[k % tasks] = true;
  std::vector<std::size_t> numbers;
  for (std::size_t t = 0; t < tasks; ++t)
    if (wanted[t]) numbers.push_back(t);
  return numbers;
}

constexpr const char* script = R"sh(#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --array={range}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={threads}
# {cases} cases; those that are finished with the same scene are skipped.
#   bash FILE [OPTIONS OF SBATCH]     sends the array, and a job that collects the rows when all tasks have ended
#   sbatch [OPTIONS OF SBATCH] FILE   sends the array alone
set -u
program=${{EPAFI:-{program}}}
folder={folder}
sweep=("$program" sweep {scene}{changes} -o "$folder")
if [ -z "${{SLURM_ARRAY_TASK_ID:-}}" ]; then
  messages=$(printf '%s' "$folder" | sed 's/%/%%/g')
  job=$(sbatch --parsable --output="$messages/slurm_%a.txt" "$@" "$0") || exit
  job=${{job%%;*}}
  echo "array job $job"
  sbatch "$@" --dependency="afterany:$job" --job-name={name}-collect --ntasks=1 --output="$messages/slurm_collect.txt" \
    --wrap="$(printf '%q ' "${{sweep[@]}}" --collect) > $(printf '%q' "$folder/sweep.csv")"
  exit
fi
worst=0
for ((k = SLURM_ARRAY_TASK_ID; k < {cases}; k += {tasks})); do
  "${{sweep[@]}}" --case "$k" -t "${{SLURM_CPUS_PER_TASK:-{threads}}}" || worst=$?
done
exit $worst
)sh";

}  // namespace

std::string array_range(const std::vector<std::size_t>& numbers) {
  std::string out;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i;
    while (end + 1 < numbers.size() && numbers[end + 1] == numbers[end] + 1) ++end;
    if (!out.empty()) out += ",";
    out += end == i ? fmt::format("{}", numbers[i]) : fmt::format("{}-{}", numbers[i], numbers[end]);
    i = end + 1;
  }
  return out;
}

std::string slurm_script(const SweepPlan& sweep, const SlurmJob& job) {
  const std::size_t tasks = std::min(sweep.cases.size(), most_array_tasks);
  const std::vector<std::size_t> open = open_tasks(sweep, tasks);
  if (open.empty()) return {};
  std::string changes;
  for (const std::string& change : sweep.overrides) changes += " --set " + shell_word(change);
  const auto whole_path = [](const std::filesystem::path& path) {
    return shell_word(std::filesystem::absolute(path).lexically_normal().string());
  };
  return fmt::format(fmt::runtime(script), fmt::arg("name", job_name(sweep.scene)),
                     fmt::arg("range", array_range(open)), fmt::arg("threads", job.threads),
                     fmt::arg("cases", sweep.cases.size()), fmt::arg("tasks", tasks),
                     fmt::arg("program", shell_word(job.program)), fmt::arg("folder", whole_path(job.folder)),
                     fmt::arg("scene", whole_path(sweep.scene)), fmt::arg("changes", changes));
}

}  // namespace epafi
