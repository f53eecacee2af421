#include "viz_export/output/output_observers.h"

#include <array>
#include <cmath>
#include <limits>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/checkpoint.h"
#include "viz_export/hdf5/stored_run.h"

using namespace epafi;

namespace {

/// x of body 1, and its reciprocal where x > 0.
class Place final : public Measure {
 public:
  std::vector<std::string> components() const override { return {"x", "reciprocal"}; }
  void sample(const StepView& view, std::vector<double>& values) override {
    const double x = view.world.position[1].x();
    values = {x, x > 0 ? 1.0 / x : std::numeric_limits<double>::quiet_NaN()};
    seen_ += 1.0;
  }
  void visit(StateVisitor& visitor, const std::string& prefix) override { visitor.value(prefix + "/seen", seen_); }

 private:
  double seen_ = 0.0;
};

/// A run of output alone: body 1 stands at x = (k - 3)^2 - 1 in step k.
struct Recording {
  SmallScene scene{3};
  RunFile run;
  MeasuresCsv csv;
  FrameWriter frames;
  MeasureRecorder measure{"place", std::make_unique<Place>(), &csv, &run, 2.0};
  StateRecorder state{&run, &frames, scene.shapes, 3.0};
  PairList pairs;
  StepReport report;
  EnergyLedger ledger;

  explicit Recording(const TemporaryFolder& f) : run(f / "run.h5", header()), csv(f / "m.csv"), frames(f.path()) {}
  Recording(const TemporaryFolder& f, std::uint64_t step)
      : run(f / "run.h5", header(), step, time(step)), csv(f / "m.csv", time(step)), frames(f.path(), time(step)) {}

  static RunFileHeader header() { return {"0.1.0", "00ff", "", "", {}}; }
  static double time(std::uint64_t step) { return 0.1 * static_cast<double>(step); }
  void steps(std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t k = from; k < to; ++k) {
      const double x = static_cast<double>(k) - 3.0;
      scene.world.time = time(k);
      scene.world.position[1].x() = x * x - 1.0;
      const StepView view{scene.world, scene.contacts, pairs, report, ledger, k, 0.1, false};
      for (Observer* o : {static_cast<Observer*>(&measure), static_cast<Observer*>(&state)})
        if (o->is_due(k)) o->observe(view);
    }
  }
  StateWalk walk() {
    return [this](StateVisitor& v) {
      scene.world.visit(v);
      measure.visit(v);
      state.visit(v);
    };
  }
};

}  // namespace

TEST_CASE("what is due every so often is due in the steps nearest to the multiples of its interval",
          "[viz_export][output]") {
  Random random(14, 0);
  for (int k = 0; k < 50; ++k) {
    const double every = k < 3 ? std::array{1.0, 0.2, 7.0}[static_cast<std::size_t>(k)] : random.uniform(1.0, 30.0);
    const EverySteps due(every);
    std::uint64_t count = 0;
    for (std::uint64_t step = 0; step < 2000; ++step) {
      if (!due.is_due(step)) continue;
      CHECK(std::abs(static_cast<double>(step) - std::max(1.0, every) * static_cast<double>(count)) <= 0.5 + 1e-9);
      ++count;
    }
    CHECK(std::abs(static_cast<double>(count) - 2000.0 / std::max(1.0, every)) <= 1.0);
  }
}

TEST_CASE("a measure's summary has last, least and greatest value, passing over NaN", "[viz_export][observers]") {
  const TemporaryFolder folder;
  Recording r(folder);
  r.steps(0, 7);  // samples at 0, 2, 4, 6: x = 8, 0, 0, 8
  const auto summary = r.measure.summary();
  CHECK((summary.at("x").last == 8 && summary.at("x").min == 0 && summary.at("x").max == 8));
  CHECK((summary.at("reciprocal").last == 0.125 && summary.at("reciprocal").min == 0.125));
  r.csv.flush();
  CHECK_THAT(read_whole_file(folder / "m.csv"), Catch::Contains("\n0.20000000000000001,place,reciprocal,nan\n"));
  CHECK(r.frames.frames() == 3);  // steps 0, 3, 6
}

TEST_CASE("recorders resumed from a checkpoint write the files of an uninterrupted run", "[viz_export][observers]") {
  const TemporaryFolder straight_folder, folder;
  Recording straight(straight_folder);
  straight.steps(0, 12);
  {
    Recording stopped(folder);
    stopped.steps(0, 6);
    stopped.csv.flush();
    stopped.run.flush();
    save_checkpoint(folder / "checkpoint.h5", {"0.1.0", "00ff", "", "", {}, 5, 0.5}, stopped.walk());
    stopped.steps(6, 9);  // goes on after the checkpoint and is killed
  }
  {
    Recording resumed(folder, 5);
    load_checkpoint(folder / "checkpoint.h5", "00ff", resumed.walk());
    resumed.steps(5, 12);  // looks again at the state of step 5
    CHECK(resumed.measure.summary().at("x").max == straight.measure.summary().at("x").max);
    CHECK(resumed.measure.summary().at("reciprocal").min == straight.measure.summary().at("reciprocal").min);
    resumed.csv.flush();
    resumed.run.flush();
  }
  straight.csv.flush();
  straight.run.flush();
  for (const char* name : {"m.csv", "frames/spheres_000003.vtp", "frames/contacts_000002.vtp"})
    CHECK(read_whole_file(folder / name) == read_whole_file(straight_folder / name));
  PvdFile list(folder / "frames.pvd"), straight_list(straight_folder / "frames.pvd");
  list.keep_until(1e9);
  straight_list.keep_until(1e9);
  REQUIRE(list.entries().size() == straight_list.entries().size());
  for (std::size_t k = 0; k < list.entries().size(); ++k) {
    const auto &e = list.entries()[k], &f = straight_list.entries()[k];
    CHECK((e.time == f.time && e.part == f.part));
    if (e.part != 3) CHECK(e.file == f.file);  // resumed frames begin with a new file of the walls
  }
  const StoredRun a(folder / "run.h5"), b(straight_folder / "run.h5");
  REQUIRE(a.snapshots() == b.snapshots());
  for (std::size_t k = 0; k < a.snapshots(); ++k)
    CHECK((a.snapshot(k).stamp.step == b.snapshot(k).stamp.step &&
           a.snapshot(k).stamp.state_hash == b.snapshot(k).stamp.state_hash));
  CHECK(a.measures().at(0).times == b.measures().at(0).times);
}
