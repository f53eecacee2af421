#include "detection/narrow/narrow_phase.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "detection/narrow/seams.h"
#include "engine/threads/parallel.h"

namespace epafi {

namespace {

bool is_mesh(ShapeRef shape) { return shape.type() == ShapeStore::type_of<TriangleMesh>(); }

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

}  // namespace

BatchNarrowPhase::BatchNarrowPhase(const ShapeStore& shapes, double reach, bool curvature, bool area)
    : shapes_(shapes), reach_(reach), curvature_(curvature), area_(area) {}

BatchNarrowPhase::~BatchNarrowPhase() = default;

void BatchNarrowPhase::join_walls() { seams_ = std::make_unique<Seams>(shapes_, reach_); }

void BatchNarrowPhase::prepare(const World& world, const PairList& list, Block& block, std::size_t begin,
                               std::size_t end) {
  block.pairs.clear();
  block.runs.clear();
  block.triangle_begin.clear();
  block.triangles.clear();
  block.meshes.clear();
  const PairTable& table = pair_table();
  const BatchInput input{shapes_, world, reach_, curvature_, {}, {}, {}};
  bool remembers = false, parts = false;
  for (std::size_t i = begin; i < end; ++i) {
    const Pair& p = list.pairs[i];
    const PairCell* cell = &table[ShapeRef{world.shape[p.a]}.type()][ShapeRef{world.shape[p.b]}.type()];
    const std::size_t first = block.triangles.size();
    if (cell->near && !cell->near(input, p, list.margin_of(p))) continue;
    if (cell->candidates) {
      cell->candidates(input, p, list.margin_of(p), block.triangles);
      if (block.triangles.size() == first) continue;  // 17 000 of 20 000 spheres in a hopper are near no triangle
      const Slot mesh = is_mesh(ShapeRef{world.shape[p.a]}) ? p.a : p.b;
      if (block.meshes.empty() || block.meshes.back() != mesh) block.meshes.push_back(mesh);
    }
    const std::size_t k = block.pairs.size();
    if (block.runs.empty() || block.runs.back().cell != cell) block.runs.push_back({k, k, cell});
    block.runs.back().end = k + 1;
    block.pairs.push_back(p);
    block.triangle_begin.push_back(static_cast<std::uint32_t>(first));
    remembers = remembers || cell->remembers;
    parts = parts || cell->parts;
  }
  block.triangle_begin.push_back(static_cast<std::uint32_t>(block.triangles.size()));
  Memory& memory = block.memory;
  memory.known.clear();
  if (remembers)
    for (const Pair& p : block.pairs) memory.known.push_back({p, world.shape[p.a], world.shape[p.b]});
  memory.caches.clear();
  memory.caches.resize(memory.known.size());
  memory.resting.clear();
  memory.resting.resize(seconds_ > 0.0 ? memory.known.size() : 0);
  memory.parts.clear();
  memory.parts.resize(parts ? memory.known.size() : 0);
  find_memory(memory);
}

/// Blocks get the memory of the list before the last in exchange, as capacity for the next one.
void BatchNarrowPhase::keep_memory() {
  if (std::exchange(restored_, false)) return;
  if (!known_) return old_.clear();  // slots were renamed
  std::size_t kept = 0;
  old_.resize(blocks_.size());
  for (Block& block : blocks_)
    if (!block.memory.known.empty()) std::swap(old_[kept++], block.memory);
  old_.resize(kept);
}

/// Both lists are sorted, so one merge suffices. Each pair is in one block of either list, so its memory is moved.
void BatchNarrowPhase::find_memory(Memory& memory) {
  if (memory.known.empty()) return;
  const Pair first = memory.known.front().pair;
  const auto ends_before = [&](const Memory& m) { return m.known.back().pair < first; };
  auto old = std::partition_point(old_.begin(), old_.end(), ends_before);
  std::size_t at = 0;
  for (std::size_t k = 0; k < memory.known.size(); ++k) {
    while (old != old_.end() && old->known[at].pair < memory.known[k].pair)
      if (++at == old->known.size()) {
        ++old;
        at = 0;
      }
    if (old == old_.end()) return;
    if (!(old->known[at] == memory.known[k])) continue;
    memory.caches[k] = std::move(old->caches[at]);
    if (!memory.resting.empty()) memory.resting[k] = std::move(old->resting[at]);
    if (!memory.parts.empty() && !old->parts.empty()) memory.parts[k] = std::move(old->parts[at]);
  }
}

void BatchNarrowPhase::collide_block(const World& world, Block& block) {
  block.contacts.clear();
  block.contacts.with_curvature = curvature_;
  block.contacts.with_area = area_;
  ContactSink sink(block.contacts);
  for (const Run& run : block.runs) {
    if (!run.cell->batch) continue;
    const std::size_t count = run.end - run.begin;
    BatchInput input{shapes_, world, reach_, curvature_, {}, {}, block.triangles, area_, motion_, least_reach_};
    if (run.cell->remembers) input.caches = std::span(block.memory.caches).subspan(run.begin, count);
    if (run.cell->remembers && !block.memory.resting.empty())
      input.resting = std::span(block.memory.resting).subspan(run.begin, count);
    if (run.cell->parts) input.parts = std::span(block.memory.parts).subspan(run.begin, count);
    if (run.cell->candidates) input.triangle_begin = std::span(block.triangle_begin).subspan(run.begin, count + 1);
    run.cell->batch(input, std::span(block.pairs).subspan(run.begin, count), sink);
  }
  block.degenerate = sink.degenerate();
}

void BatchNarrowPhase::list_meshes() {
  meshes_.clear();
  for (const Block& block : blocks_) meshes_.insert(meshes_.end(), block.meshes.begin(), block.meshes.end());
  std::sort(meshes_.begin(), meshes_.end());
  meshes_.erase(std::unique(meshes_.begin(), meshes_.end()), meshes_.end());
}

void BatchNarrowPhase::join(ContactSet& out) {
  std::size_t total = 0;
  degenerate_ = 0;
  for (Block& block : blocks_) {
    block.first = total;
    total += block.contacts.size();
    degenerate_ += block.degenerate;
  }
  out.with_curvature = curvature_;
  out.with_area = area_;
  out.renew(total);
  out.force.clear();
  out.moment.clear();
  if (total == 0) return;
  parallel_for(
      blocks_.size(),
      [&](std::size_t k) {
        const ContactSet& from = blocks_[k].contacts;
        const auto place = [at = static_cast<std::ptrdiff_t>(blocks_[k].first)](const auto& source, auto& target) {
          if (!source.empty())
            std::copy(source.begin(), source.end(), target.begin() + at);  // else no column to point into
        };
        place(from.a, out.a);
        place(from.b, out.b);
        place(from.feature, out.feature);
        place(from.gap, out.gap);
        place(from.normal, out.normal);
        place(from.arm, out.arm);
        place(from.effective_radius, out.effective_radius);
        place(from.area, out.area);
      },
      1);
}

void BatchNarrowPhase::predict_motion(const World& world) {
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
  predict_motion(world);
  const bool fresh = !known_ || generation_ != list.generation || pairs_ != n;
  if (fresh) {
    keep_memory();
    seams_known_ = false;
    blocks_.resize((n + block_size - 1) / block_size);
    generation_ = list.generation;
    pairs_ = n;
    known_ = true;
  }
  parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end, std::size_t b) {
    if (fresh) prepare(world, list, blocks_[b], begin, end);
    collide_block(world, blocks_[b]);
  });
  if (fresh) list_meshes();
  contacts.meshes = meshes_;
  join(contacts);
}

void BatchNarrowPhase::unite(const World& world, ContactSet& contacts) {
  if (!seams_ || contacts.size() == 0) return;  // spheres in their own loop are not among the contacts
  if (!seams_known_ || !seams_->knows(world)) seams_->find(world, seconds_ > 0.0);
  seams_known_ = true;
  seams_->hide(world, contacts);
}

void BatchNarrowPhase::visit(StateVisitor& visitor) {
  if (!(seconds_ > 0.0)) return;
  std::vector<Known> pairs;
  std::vector<RestingPatch> resting;
  const auto add = [&](const Memory& memory) {
    for (std::size_t k = 0; k < memory.resting.size(); ++k)
      if (const RestingPatch* patch = memory.resting[k].get(); patch && patch->count > 0) {
        pairs.push_back(memory.known[k]);
        resting.push_back(*patch);
      }
  };
  if (restored_ && !old_.empty()) add(old_.front());
  for (const Block& block : known_ ? std::span<const Block>(blocks_) : std::span<const Block>()) add(block.memory);
  const std::vector<Known> pairs_here = pairs;
  const std::vector<RestingPatch> resting_here = resting;
  visitor.rows(RowsOf::pairs, "narrow_phase/pair", pairs);
  visitor.rows(RowsOf::contacts, "narrow_phase/resting", resting);
  if (same_bytes(pairs, pairs_here) && same_bytes(resting, resting_here)) return;  // it was saved, or nothing is new
  old_.clear();
  if (!pairs.empty()) {
    Memory& old = old_.emplace_back();
    old.caches.resize(pairs.size());
    old.known = std::move(pairs);
    for (const RestingPatch& patch : resting) old.resting.push_back(std::make_unique<RestingPatch>(patch));
  }
  restored_ = true;
  known_ = false;
}

}  // namespace epafi
