// Files written by a thread of their own while the run goes on: the same bytes, in the same order, and no error is
// lost.
#include "viz_export/output/output_thread.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <stdexcept>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/output/output_observers.h"

using namespace epafi;

namespace {

class Height final : public Measure {
 public:
  std::vector<std::string> components() const override { return {"z"}; }
  void sample(const StepView& view, std::vector<double>& values) override { values = {view.world.position[0].z()}; }
};

/// Contents by name of all files of a folder.
std::map<std::string, std::string> files_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      out[std::filesystem::relative(entry.path(), folder).string()] = read_whole_file(entry.path());
  return out;
}

/// Bodies that move, come and go at random; a frame every few steps, a measure in each.
std::map<std::string, std::string> random_run(std::uint64_t seed, bool beside) {
  Random random(seed, 0);
  const TemporaryFolder folder;
  SmallScene scene(3 + random.bits() % 3000);
  OutputThread thread;
  {
    RunFile run(folder / "run.h5", {"0.1.0", "00ff", "", "", {}});
    FrameWriter frames(folder.path());
    const bool solver = random.uniform() < 0.5;
    const auto residuals = [&] {
      return std::vector<float>(solver ? scene.contacts.size() : 0, static_cast<float>(scene.world.time));
    };
    const EverySteps due(1.0 + static_cast<double>(random.bits() % 4));
    StateRecorder state(&run, &frames, scene.shapes, due, residuals, "stage");
    MeasureRecorder measure("height", std::make_unique<Height>(), nullptr, &run, 1.0);
    if (beside) run.write_beside(thread);
    if (beside) state.write_beside(thread);
    const PairList pairs;
    const StepReport report;
    const EnergyLedger ledger;
    for (std::uint64_t k = 0; k < 20; ++k) {
      scene.move(random.uniform());
      const double what = random.uniform();
      if (what < 0.2) scene.add_sphere();
      if (what > 0.8 && scene.world.size() > 4) {  // behind those that touch
        const BodyId last = scene.world.id[scene.world.size() - 1];
        scene.world.remove(std::span(&last, 1));
      }
      scene.contacts.force[0] = Vec3(random.uniform(), 0, -1);
      const StepView view{scene.world, scene.contacts, pairs, report, ledger, k, 0.1, scene.world.size(), k == 19};
      for (Observer* o : {static_cast<Observer*>(&measure), static_cast<Observer*>(&state)})
        if (o->is_due(k) || view.last) o->observe(view);
    }
    thread.wait();
    run.flush();
  }
  return files_of(folder.path());
}

}  // namespace

TEST_CASE("files written beside a run have the bytes of those written at once", "[viz_export][output]") {
  const support::KeepThreads keep;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    set_thread_count(1 + static_cast<int>(seed % 3));
    const auto at_once = random_run(seed, false), beside = random_run(seed, true);
    REQUIRE(at_once.size() >= 5);
    for (const auto& [name, bytes] : at_once) {
      INFO("seed " << seed << ", " << name);
      REQUIRE(beside.count(name) == 1);
      CHECK(beside.at(name) == bytes);
    }
    CHECK(beside.size() == at_once.size());
  }
}

TEST_CASE("jobs beside a run are done one by one in their order", "[viz_export][output]") {
  std::vector<int> done;
  std::atomic<int> at_work{0}, most{0}, threads{0};
  {
    OutputThread thread;
    for (int k = 0; k < 100; ++k)
      thread.add([&, k] {
        most = std::max<int>(most, ++at_work);
        threads = std::max<int>(threads, thread_count());
        done.push_back(k);
        --at_work;
      });
  }  // its end waits for the last one
  REQUIRE(done.size() == 100);
  CHECK(std::is_sorted(done.begin(), done.end()));
  CHECK((most == 1 && threads == 1));
}

TEST_CASE("what a job beside a run throws comes with the next one, which is not begun", "[viz_export][output]") {
  OutputThread thread;
  thread.wait();
  thread.add([] { throw FileError("run.h5: disk full"); });
  bool begun = false;
  CHECK_THROWS_WITH(thread.add([&] { begun = true; }), "run.h5: disk full");
  CHECK(!begun);
  CHECK_NOTHROW(thread.wait());  // told once
  thread.add([] { throw std::runtime_error("another"); });
  CHECK_THROWS_WITH(thread.wait(), "another");
  thread.add([&] { begun = true; });
  thread.wait();
  CHECK(begun);
}

TEST_CASE("a frame that cannot be written beside a run ends it at the next one", "[viz_export][output]") {
  const TemporaryFolder folder;
  SmallScene scene(50);
  OutputThread thread;
  FrameWriter frames(folder.path());
  StateRecorder state(nullptr, &frames, scene.shapes, 1.0);
  state.write_beside(thread);
  const PairList pairs;
  const StepReport report;
  const EnergyLedger ledger;
  const StepView view{scene.world, scene.contacts, pairs, report, ledger, 1, 0.1, scene.world.size(), false};
  std::filesystem::create_directories(folder / "frames/spheres_000000.vtp.part");  // cannot be opened to write
  state.observe(view);
  CHECK_THROWS_WITH(state.observe(view), Catch::Contains("spheres_000000.vtp: cannot write"));
  CHECK(!std::filesystem::exists(folder / "frames.pvd"));
}
