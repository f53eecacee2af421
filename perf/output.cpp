/// @file output.cpp  Cost of a frame, a snapshot, a checkpoint and the state hash of N spheres, s and MB per million
/// bodies. Beside each time the error of what was written: the largest difference of a position after reading it back
/// (snapshot, checkpoint), and the state hash before and after; "-" where nothing is read back here (frames: by
/// tests/viz_export/read_back).
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/hdf5/checkpoint.h"
#include "viz_export/hdf5/run_file.h"
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/vtk/frame_writer.h"

using namespace epafi;

namespace {

/// Least processor seconds of five calls: other processes disturb it least.
template <class F>
double seconds(const F& f) {
  double least = 1e300;
  for (int k = 0; k < 5; ++k) {
    const std::clock_t start = std::clock();
    f(k);
    least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return least;
}

double megabytes(const std::filesystem::path& path) {
  return 1e-6 * static_cast<double>(std::filesystem::file_size(path));
}

void row(const char* what, std::size_t n, double time, double size, std::optional<double> error,
         const std::string& hash) {
  const double per_million = 1e6 / static_cast<double>(n);
  char text[16] = "-";
  if (error) std::snprintf(text, sizeof text, "%.2g", *error);
  std::printf("%-12s %9zu %10.4f %10.1f %10s  %s\n", what, n, time * per_million, size * per_million, text,
              hash.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t n = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 100000;
  const TemporaryFolder folder;
  SmallScene scene(n);
  SurfaceCache surfaces(scene.shapes);
  std::printf("%-12s %9s %10s %10s %10s  %s\n", "what", "bodies", "s/million", "MB/million", "error [m]", "state hash");
  std::vector<BodyRecord> bodies;
  const std::string hash = state_hash(scene.world);
  const double records = seconds([&](int) { bodies = body_records(scene.world, surfaces); });
  double moved = 0;
  for (std::size_t i = 0; i < n; ++i)
    moved = std::max(moved, (bodies[i + 1].pose.position - scene.world.position[i + 1]).norm());
  row("records", n, records, 0, moved, hash);
  row("state hash", n, seconds([&](int) { state_hash(scene.world); }), 0, std::nullopt, state_hash(scene.world));
  {
    FrameWriter frames(folder.path());
    const double frame = seconds([&](int k) { frames.write(k, bodies, {}); });
    row("frame", n, frame, megabytes(folder / "frames/spheres_000000.vtp"), std::nullopt, hash);
  }
  {
    RunFile run(folder / "run.h5", {"0.1.0", "00ff", "", "", {}});
    const double empty = megabytes(folder / "run.h5");
    const double snapshot = seconds([&](int k) {
      run.add_snapshot({static_cast<std::uint64_t>(k), 0.1 * k, hash, true}, bodies);
    });
    run.flush();
    const double size = (megabytes(folder / "run.h5") - empty) / 5;
    double error = 0;
    const StoredRun stored(folder / "run.h5");
    const StoredSnapshot snapshot_back = stored.snapshot(0);
    for (std::size_t i = 0; i < n; ++i)
      error = std::max(error, (snapshot_back.bodies[i + 1].pose.position - scene.world.position[i + 1]).norm());
    row("snapshot", n, snapshot, size, error, hash);
  }
  const StateWalk walk = [&](StateVisitor& v) { scene.world.visit(v); };
  std::vector<Vec3> before;
  for (const Vec3& x : scene.world.position) before.push_back(x);
  const double save = seconds([&](int) {
    save_checkpoint(folder / "checkpoint.h5", {"1.0.0", "00ff", "", "", {}, 0, 0.0}, walk);
  });
  for (Vec3& x : scene.world.position) x.setConstant(1e9);  // so that what is not restored shows
  const double load = seconds([&](int) { load_checkpoint(folder / "checkpoint.h5", "00ff", walk); });
  double error = 0;
  for (std::size_t i = 0; i < before.size(); ++i) error = std::max(error, (before[i] - scene.world.position[i]).norm());
  row("checkpoint", n, save, megabytes(folder / "checkpoint.h5"), error, hash);
  row("restore", n, load, 0, error, state_hash(scene.world));
}
