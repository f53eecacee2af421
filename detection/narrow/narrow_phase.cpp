#include "detection/narrow/narrow_phase.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/parallel.h"

namespace epafi {

namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

}  // namespace

void BatchNarrowPhase::prepare(const World& world, const PairList& list, Block& block, std::size_t begin,
                               std::size_t end) {
  block.pairs.clear(), block.runs.clear(), block.triangle_begin.clear(), block.triangles.clear(), block.known.clear();
  const PairTable& table = pair_table();
  const BatchInput input{shapes_, world, reach_, curvature_, {}, {}, {}};
  bool remembers = false;
  for (std::size_t i = begin; i < end; ++i) {
    const Pair& p = list.pairs[i];
    const PairCell* cell = &table[ShapeRef{world.shape[p.a]}.type()][ShapeRef{world.shape[p.b]}.type()];
    const std::size_t first = block.triangles.size();
    if (cell->candidates) {
      cell->candidates(input, p, list.margin_of(p), block.triangles);
      if (block.triangles.size() == first) continue;  // 17 000 of 20 000 spheres in a hopper are near no triangle
    }
    const std::size_t k = block.pairs.size();
    if (block.runs.empty() || block.runs.back().cell != cell) block.runs.push_back({k, k, cell});
    block.runs.back().end = k + 1;
    block.pairs.push_back(p), block.triangle_begin.push_back(static_cast<std::uint32_t>(first));
    remembers = remembers || cell->remembers;
  }
  block.triangle_begin.push_back(static_cast<std::uint32_t>(block.triangles.size()));
  block.caches.assign(remembers ? block.pairs.size() : 0, PairCache{});
  block.resting.assign(seconds_ > 0.0 ? block.caches.size() : 0, RestingPatch{});
  if (remembers)
    for (const Pair& p : block.pairs) block.known.push_back({p, world.shape[p.a], world.shape[p.b]});
  find_caches(block);
}

void BatchNarrowPhase::keep_caches() {
  if (std::exchange(restored_, false)) return;
  if (!known_) return old_known_.clear();  // slots were renamed
  const auto join = [&](auto column, auto& out) {
    std::vector<std::size_t>& place = block_results<std::size_t>(blocks_.size() + 1, 0);
    for (std::size_t i = 0; i < blocks_.size(); ++i) place[i + 1] = place[i] + (blocks_[i].*column).size();
    out.resize(place.back());
    const auto copy = [&](std::size_t i) {
      const auto& from = blocks_[i].*column;
      std::copy(from.begin(), from.end(), out.begin() + static_cast<std::ptrdiff_t>(place[i]));
    };
    parallel_for(blocks_.size(), copy, 1);
  };
  join(&Block::known, old_known_), join(&Block::caches, old_caches_), join(&Block::resting, old_resting_);
}

/// Both lists are sorted: one merge.
void BatchNarrowPhase::find_caches(Block& block) const {
  if (old_known_.empty() || block.known.empty()) return;
  auto old = std::lower_bound(old_known_.begin(), old_known_.end(), block.known.front().pair,
                              [](const Known& k, const Pair& p) { return k.pair < p; });
  for (std::size_t k = 0; k < block.known.size(); ++k) {
    while (old != old_known_.end() && old->pair < block.known[k].pair) ++old;
    if (old == old_known_.end()) return;
    if (!(*old == block.known[k])) continue;
    const auto at = static_cast<std::size_t>(old - old_known_.begin());
    block.caches[k] = old_caches_[at];
    if (!block.resting.empty()) block.resting[k] = old_resting_[at];
  }
}

void BatchNarrowPhase::collide_block(const World& world, Block& block) {
  block.contacts.clear();
  block.contacts.with_curvature = curvature_, block.contacts.with_area = area_;
  ContactSink sink(block.contacts);
  for (const Run& run : block.runs) {
    if (!run.cell->batch) continue;
    const std::size_t count = run.end - run.begin;
    BatchInput input{shapes_, world, reach_, curvature_, {}, {}, block.triangles, area_, motion_, least_reach_};
    if (run.cell->remembers) input.caches = std::span(block.caches).subspan(run.begin, count);
    if (run.cell->remembers && !block.resting.empty())
      input.resting = std::span(block.resting).subspan(run.begin, count);
    if (run.cell->candidates) input.triangle_begin = std::span(block.triangle_begin).subspan(run.begin, count + 1);
    run.cell->batch(input, std::span(block.pairs).subspan(run.begin, count), sink);
  }
  block.degenerate = sink.degenerate();
}

void BatchNarrowPhase::join(ContactSet& out) {
  std::size_t total = 0;
  degenerate_ = 0;
  for (Block& block : blocks_) {
    block.first = total, total += block.contacts.size();
    degenerate_ += block.degenerate;
  }
  out.with_curvature = curvature_, out.with_area = area_;
  out.a.resize(total), out.b.resize(total), out.feature.resize(total);
  out.gap.resize(total), out.normal.resize(total), out.arm.resize(total);
  out.effective_radius.resize(curvature_ ? total : 0), out.area.resize(area_ ? total : 0);
  out.force.clear(), out.moment.clear();
  parallel_for(
      blocks_.size(),
      [&](std::size_t k) {
        const ContactSet& from = blocks_[k].contacts;
        const auto place = [at = static_cast<std::ptrdiff_t>(blocks_[k].first)](const auto& source, auto& target) {
          if (!source.empty())
            std::copy(source.begin(), source.end(), target.begin() + at);  // else no column to point into
        };
        place(from.a, out.a), place(from.b, out.b), place(from.feature, out.feature);
        place(from.gap, out.gap), place(from.normal, out.normal), place(from.arm, out.arm);
        place(from.effective_radius, out.effective_radius), place(from.area, out.area);
      },
      1);
}

void BatchNarrowPhase::foresee_motion(const World& world) {
  if (!(seconds_ > 0.0)) return;
  motion_.resize(world.size());
  parallel_for(world.size(), [&](std::size_t s) {
    double speed = world.velocity[s].norm();
    if (world.rotates() && !world.angular_velocity[s].isZero(0.0))
      speed += world.angular_velocity[s].norm() * shapes_.bounding_radius(ShapeRef{world.shape[s]});
    motion_[s] = 2.0 * seconds_ * speed;
  });
}

void BatchNarrowPhase::collide(const World& world, const PairList& list, ContactSet& contacts) {
  const std::size_t n = list.pairs.size();
  foresee_motion(world);
  const bool fresh = !known_ || generation_ != list.generation || pairs_ != n;
  if (fresh) {
    keep_caches();
    blocks_.resize((n + block_size - 1) / block_size);
    generation_ = list.generation, pairs_ = n, known_ = true;
  }
  parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end, std::size_t b) {
    if (fresh) prepare(world, list, blocks_[b], begin, end);
    collide_block(world, blocks_[b]);
  });
  join(contacts);
}

void BatchNarrowPhase::visit(StateVisitor& visitor) {
  if (!(seconds_ > 0.0)) return;
  std::vector<Known> pairs;
  std::vector<RestingPatch> resting;
  if (restored_) pairs = old_known_, resting = old_resting_;
  for (const Block& block : known_ ? std::span<const Block>(blocks_) : std::span<const Block>()) {
    for (std::size_t k = 0; k < block.resting.size(); ++k)
      if (block.resting[k].count > 0) pairs.push_back(block.known[k]), resting.push_back(block.resting[k]);
  }
  const std::vector<Known> pairs_here = pairs;
  const std::vector<RestingPatch> resting_here = resting;
  visitor.column("narrow_phase/pair", pairs), visitor.column("narrow_phase/resting", resting);
  if (same_bytes(pairs, pairs_here) && same_bytes(resting, resting_here)) return;  // it was saved, or nothing is new
  old_known_.swap(pairs), old_resting_.swap(resting), old_caches_.assign(old_known_.size(), PairCache{});
  restored_ = true, known_ = false;
}

}  // namespace epafi
