// An observer of one's own: it sees every finished step and cannot change it. Here: a histogram of contact forces.
//   ./watch scene.toml
#include <epafi/epafi.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

class ForceHistogram final : public epafi::Observer {
 public:
  bool is_due(std::uint64_t step) const override { return step > 0 && step % 50 == 0; }
  void observe(const epafi::StepView& view) override {
    double sum = 0;
    for (const auto& f : view.contacts.force) sum += f.norm();
    const double mean = view.contacts.force.empty() ? 0.0 : sum / static_cast<double>(view.contacts.force.size());
    for (const auto& f : view.contacts.force) {
      const auto bin = static_cast<std::size_t>(2.0 * f.norm() / mean);
      if (bin >= bins.size()) bins.resize(bin + 1);
      ++bins[bin];
      ++count;
    }
  }
  std::vector<std::size_t> bins;  ///< of half the mean force each
  std::size_t count = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::puts("usage: watch SCENE.toml");
    return 2;
  }
  auto assembly = epafi::load(argv[1]);
  auto observer = std::make_unique<ForceHistogram>();
  const ForceHistogram& seen = *observer;
  assembly->simulation->observers.push_back(std::move(observer));
  for (int k = 0; k < 400; ++k)
    if (assembly->simulation->advance()) return 4;
  for (std::size_t k = 0; k < seen.bins.size() && k < 10; ++k)
    std::printf("%.1f to %.1f of the mean force: %.3f\n", 0.5 * static_cast<double>(k),
                0.5 * static_cast<double>(k + 1), static_cast<double>(seen.bins[k]) / static_cast<double>(seen.count));
  return seen.count > 0 ? 0 : 1;
}
