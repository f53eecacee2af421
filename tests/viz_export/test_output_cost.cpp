// What output costs: `test_viz_export "[output_cost]"` prints seconds and megabytes; hidden, because it checks no
// claim.
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "tests/support/catch.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/checkpoint.h"
#include "viz_export/frame_writer.h"
#include "viz_export/run_file.h"

using namespace epafi;

namespace {

/// Least seconds of five calls: the others waited for someone else.
template <class F>
double seconds(const F& f) {
  double least = 1e300;
  for (int k = 0; k < 5; ++k) {
    const auto start = std::chrono::steady_clock::now();
    f(k);
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

double megabytes(const std::filesystem::path& path) {
  return 1e-6 * static_cast<double>(std::filesystem::file_size(path));
}

}  // namespace

TEST_CASE("cost of a frame, a snapshot and a checkpoint of 100 000 spheres", "[.output_cost]") {
  constexpr std::size_t n = 100000;
  const TemporaryFolder folder;
  SmallScene scene(n);
  SurfaceCache surfaces(scene.shapes);
  FrameWriter frames(folder.path());
  RunFile run(folder / "run.h5", {"0.1.0", "00ff", "", "", {}});
  std::vector<BodyRecord> bodies;
  const double records = seconds([&](int) { bodies = body_records(scene.world, surfaces); });
  const double frame = seconds([&](int k) { frames.write(k, bodies, {}); });
  const double hash = seconds([&](int) { state_hash(scene.world); });
  const double empty = megabytes(folder / "run.h5");
  const double snapshot = seconds([&](int k) {
    run.add_snapshot({static_cast<std::uint64_t>(k), 0.1 * k, "", true}, bodies);
  });
  const StateWalk walk = [&](StateVisitor& v) { scene.world.visit(v); };
  const double save = seconds([&](int) { save_checkpoint(folder / "checkpoint.h5", {}, walk); });
  const double load = seconds([&](int) { load_checkpoint(folder / "checkpoint.h5", {}, walk); });
  std::printf("per 100 000 spheres: records %.4f s, frame %.4f s %.1f MB, state hash %.4f s, snapshot %.4f s %.1f MB\n",
              records, frame, megabytes(folder / "frames/spheres_000000.vtp"), hash, snapshot,
              (megabytes(folder / "run.h5") - empty) / 5);
  std::printf("checkpoint: save %.4f s (with fsync), load %.4f s, %.1f MB\n", save, load,
              megabytes(folder / "checkpoint.h5"));
  SUCCEED();
}
