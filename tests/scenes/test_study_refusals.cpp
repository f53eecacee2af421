// Studies that lack something, or ask for what there is not: told with the place in the study.
#include <sys/resource.h>
#include <csignal>
#include <fstream>

#include "scenes/study/case_run.h"
#include "scenes/study/chart.h"
#include "scenes/study/limits.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;

TEST_CASE("what a study lacks, or takes for an error, is told with its place", "[scenes][study]") {
  const TemporaryFolder folder;
  const auto file = folder / "study.toml";
  const auto refusal = [&](const std::string& scene, const std::string& more, bool limits) {
    std::ofstream(file) << "scene = \"" EPAFI_SOURCE_DIR "/scenes/library/" << scene << "\"\n" << more;
    const Study study = read_study(file.string(), {});
    try {
      if (limits)
        run_limits(study, folder / "out", 1, [](const std::string&) {});
      else
        chart_of(study, folder / "out", [](const std::string&) {});
    } catch (const SceneError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const std::string vary = "vary = [ { \"contact.friction\" = [0.1, 0.2] } ]\n";
  for (const std::string scene : {"stacking/stack.toml", "wheel_rail/hertz.toml"}) {
    CHECK_THAT(refusal(scene, vary, false), Catch::Contains("study.toml:1:1: error: missing key 'error'"));
    CHECK_THAT(refusal(scene, vary + "\nerror = \"presure\"\n", false),
               Catch::Contains("study.toml:4:9: error: unknown error 'presure'; write "));
    CHECK_THAT(refusal(scene, vary, true), Catch::Contains("study.toml:1:1: error: a limits study has one or two"));
  }
}

TEST_CASE("a case that cannot write its files ends the study with the file and the reason", "[scenes][study]") {
  // files of cases may be so long and no longer, as on a full disk; a run writes about 200 kB
  const TemporaryFolder folder;
  const std::string scene = EPAFI_SOURCE_DIR "/scenes/library/stacking/column.toml";
  struct rlimit kept {};
  getrlimit(RLIMIT_FSIZE, &kept);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  for (const rlim_t longest : {0, 700, 9'000}) {
    const struct rlimit shorter { longest, kept.rlim_max };
    std::string text;
    setrlimit(RLIMIT_FSIZE, &shorter);
    try {
      run_cases(scene, {{{}, folder / "one"}, {{}, folder / "two"}}, {EPAFI_BINARY_DIR "/bin/epafi", 1, 0.0, false}, 2,
                [](std::size_t, const CaseResult&) {});
    } catch (const FileError& e) {
      text = e.what();
    }
    setrlimit(RLIMIT_FSIZE, &kept);
    INFO("longest file " << longest << " bytes");
    CHECK_THAT(
        text, Catch::Contains((folder / "").string()) && (Catch::Contains("cannot write") || Catch::Contains("large")));
  }
  std::signal(SIGXFSZ, handler);
}
