// A drum that turns for a day: its balls stay in it, the ledger closes, memory does not grow, and the bits are those of
// every run.
#include <malloc.h>

#include <cmath>
#include <fstream>

#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

constexpr double radius = 0.04, half_length = 0.015;  // of the drum [m]

/// A drum about y of 24 plates and two ends, as triangles.
std::string drum_file() {
  std::string path = EPAFI_BINARY_DIR "/drum.obj";
  std::ofstream out(path);
  constexpr int plates = 24;
  for (int k = 0; k < plates; ++k)
    for (const double y : {-half_length, half_length})
      out << "v " << radius * std::cos(2 * M_PI * k / plates) << " " << y << " "
          << radius * std::sin(2 * M_PI * k / plates) << "\n";
  out << "v 0 " << -half_length << " 0\nv 0 " << half_length << " 0\n";
  for (int k = 0; k < plates; ++k) {
    const int a = 2 * k + 1, b = a + 1, c = 2 * ((k + 1) % plates) + 1, d = c + 1;
    out << "f " << a << " " << d << " " << c << "\nf " << a << " " << b << " " << d << "\n";
    out << "f " << 2 * plates + 1 << " " << a << " " << c << "\nf " << 2 * plates + 2 << " " << d << " " << b << "\n";
  }
  return path;
}

/// Twelve balls of 10 mm in a drum of 80 mm at 20 turns a minute. Steps of 4 ms: a ball moves by a fifteenth of its
/// radius.
SceneRun turned_drum(double seconds, int threads) {
  set_thread_count(threads);
  return start_text("run = { duration = " + std::to_string(seconds) +
                    R"(, time_step = 4e-3, output_interval = 3600.0, seed = 7 }
world = { gravity = [0, 0, -9.81] }
material.glass = { density = 2500.0, youngs_modulus = "20 MPa", poissons_ratio = 0.3 }
contact = { method = "nonsmooth", restitution = 0.3, friction = 0.4, nonsmooth = { solver = "pgs", iterations = 20 } }
[[body]]
name = "drum"
shape = { mesh = { file = ")" +
                    drum_file() + R"(" } }
material = "glass"
motion = { rotation = { axis = [0, 1, 0], rate = "20 rpm", about = [0, 0, 0] } }
[[body]]
name = "ball"
repeat = [3, 2, 2]
shape = { sphere = { radius = 0.005 } }
material = "glass"
position = ["= -0.012 + 0.012*i", "= -0.006 + 0.012*j", "= -0.006 + 0.012*k"]
)");
}

/// What the ledger leaves open when the work of moving overlapping bodies apart is counted, over all that was
/// dissipated.
double open_ledger(SceneRun& run, double stored_at_start) {
  const Energy now = run.simulation().ledger.measure(run.simulation().world);
  return std::abs(now.stored() - stored_at_start + now.dissipated - now.work - now.correction) / now.dissipated;
}

void check_drum(double seconds) {
  const support::KeepThreads keep;
  SceneRun run = turned_drum(seconds, 1);
  const double stored = run.simulation().ledger.measure(run.simulation().world).stored();
  const std::uint64_t tenth = run.assembly->steps / 10;
  run.advance_to(tenth);
  const std::size_t heap = mallinfo2().uordblks;
  const std::string hash = run.hash();
  run.advance_to(0);
  const std::size_t end = mallinfo2().uordblks, growth = end > heap ? end - heap : 0;
  const World& w = run.simulation().world;
  double outermost = 0, lengthwise = 0;
  for (Slot s = 0; s < w.size(); ++s) {
    if (!w.is_movable(s)) continue;
    outermost = std::max(outermost, std::hypot(w.position[s].x(), w.position[s].z()));
    lengthwise = std::max(lengthwise, std::abs(w.position[s].y()));
  }
  INFO(run.assembly->steps << " steps: open " << open_ledger(run, stored) << ", outermost " << outermost << ", heap "
                           << growth);
  CHECK(run.failure.empty());
  CHECK(w.size() == 13);
  CHECK(outermost < radius - 0.004);  // centres: a radius of 5 mm less what overlaps
  CHECK(lengthwise < half_length - 0.004);
  // every step rounds sums of 1e-5 J to 1e-21, and dissipates 1e-7 J
  CHECK(open_ledger(run, stored) < 1e-6);
  CHECK(growth < 65536);  // columns may still find their largest size
  SceneRun again = turned_drum(seconds, 3);
  again.advance_to(tenth);
  CHECK(again.hash() == hash);
}

}  // namespace

TEST_CASE("a drum that turns for a minute keeps its balls, its ledger and its bits", "[physics][drum]") {
  check_drum(60.0);
}

TEST_CASE("a drum that turns for a day keeps its balls, its ledger and its bits", "[physics][drum][slow]") {
  check_drum(86400.0);
}
