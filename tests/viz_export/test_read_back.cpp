// Writes the folder that read_back.py opens with VTK and h5py; hidden, because only that script knows where it goes.
#include <cstdlib>

#include "tests/support/catch.h"
#include "tests/viz_export/small_scene.h"
#include "viz_export/output/output_observers.h"
#include "viz_export/vtk/frame_writer.h"

using namespace epafi;

namespace {

/// A grid of n x n squares in several zlib blocks: point k at (k % (n+1), k / (n+1), 0), polygon f has number f.
PolyData grid(std::int32_t n) {
  PolyData d;
  for (std::int32_t k = 0; k < (n + 1) * (n + 1); ++k)
    for (std::int32_t c : {k % (n + 1), k / (n + 1), 0}) d.points.push_back(static_cast<float>(c));
  VtpColumn<std::uint32_t> number;
  for (std::int32_t f = 0; f < n * n; ++f) {
    const std::int32_t corner = f % n + (f / n) * (n + 1);
    for (std::int32_t k : {corner, corner + 1, corner + n + 2, corner + n + 1}) d.polygons.connectivity.push_back(k);
    d.polygons.offsets.push_back(4 * (f + 1));
    number.push_back(static_cast<std::uint32_t>(f));
  }
  d.cell_data.push_back({"number", 1, number});
  return d;
}

/// x of all bodies together.
class SumOfX final : public Measure {
 public:
  std::vector<std::string> components() const override { return {"sum", "count"}; }
  void sample(const StepView& view, std::vector<double>& values) override {
    values = {0.0, static_cast<double>(view.world.size())};
    for (const Vec3& x : view.world.position) values[0] += x.x();
  }
};

}  // namespace

TEST_CASE("the sample for other readers", "[.sample]") {
  const char* folder = std::getenv("EPAFI_SAMPLE_FOLDER");
  REQUIRE(folder != nullptr);
  const std::filesystem::path out(folder);
  SmallScene scene(1000);
  RunFile run(out / "run.h5", {"0.1.0", "00ff", "Kies \u00b5", "[run]\nduration = 1\n", {"a=1", "b=2"}});
  FrameWriter frames(out);
  MeasuresCsv csv(out / "measures.csv");
  StateRecorder state(&run, &frames, scene.shapes, 1);
  MeasureRecorder measure("position", std::make_unique<SumOfX>(), &csv, &run, 1);
  const PairList pairs;
  const StepReport report;
  const EnergyLedger ledger;
  for (std::uint64_t k = 0; k < 3; ++k) {
    const StepView view{scene.world, scene.contacts, pairs, report, ledger, k, 0.5, k == 2};
    measure.observe(view);
    state.observe(view);
    scene.move(0.5);
  }
  VtpFile(grid(300)).write(out / "grid_compressed.vtp");
  write_vtp_rows(out / "grid_plain.vtp", 1, [&](std::size_t, std::size_t) { return grid(300); });
  VtpFile(PolyData{}).write(out / "nothing.vtp");
}
