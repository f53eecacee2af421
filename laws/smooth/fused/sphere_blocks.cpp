#include "laws/smooth/fused/sphere_blocks.h"

#include <algorithm>
#include <tuple>

#include "engine/error.h"
#include "engine/parallel.h"
#include "laws/smooth/fused/body_pass.h"

namespace epafi {

std::uint32_t opposite_image(std::uint32_t image) {
  const auto turned = [](std::uint32_t code) {
    const auto bits = [code](int k) { return -static_cast<int>(code >> (2 * k) & 3u); };
    return image_code(bits(0), bits(1), bits(2));
  };
  return turned(image) | turned(image >> 8) << 8;
}

namespace {

/// Appends pairs of one run to a block.
class RunWriter {
 public:
  RunWriter(SphereBlocks::Block& block, bool periodic) : block_(block), periodic_(periodic) {}
  void open(std::int32_t plane, bool across) {
    const auto at = static_cast<std::uint32_t>(block_.pairs.size());
    block_.runs.push_back({at, at, plane, across});
  }
  void add(const SpherePair& p) {
    block_.pairs.push_back({SpherePlace(p.a), SpherePlace(p.b)});
    ++block_.runs.back().end;
    if (!periodic_) return;
    const auto step = [&](int k) { return static_cast<double>(image_step(p.image >> k)); };
    const Lanes cells{step(0), step(2), step(4), 0.0};
    block_.images.push_back({cells, p.image >> 8});
  }
  void close() {
    if (block_.runs.back().begin == block_.runs.back().end) return block_.runs.pop_back();
    while (block_.pairs.size() % SphereBlocks::pairs_per_byte != 0) {
      block_.pairs.push_back(block_.pairs.back());
      if (periodic_) block_.images.push_back(block_.images.back());
    }
  }

 private:
  SphereBlocks::Block& block_;
  bool periodic_;
};

}  // namespace

// --- layout

void SphereBlocks::rebuild(const World& world, std::vector<SpherePair> pairs, std::vector<SpherePlane> planes,
                           std::span<const double> radius, bool friction) {
  std::vector<Kept> kept = laid_out_ ? springs() : std::move(kept_);
  kept_.clear(), laid_out_ = true;
  planes_ = std::move(planes);
  place(world, std::move(pairs), radius, friction);
  if (friction) restore(kept, world.size());
}

template <class T>
void SphereBlocks::by_first_slot(std::vector<T>& list, std::size_t slots) {
  first_.assign(slots + 2, 0);
  for (const T& x : list) ++first_[x.a + 2];
  for (std::size_t s = 2; s < first_.size(); ++s) first_[s] += first_[s - 1];
  std::vector<T> out(list.size());
  for (const T& x : list) out[first_[x.a + 1]++] = x;
  list = std::move(out);
}

void SphereBlocks::place(const World& world, std::vector<SpherePair> pairs, std::span<const double> radius,
                         bool friction) {
  EPAFI_REQUIRE(world.size() < most_bodies, "the loop over spheres addresses 67 million bodies");
  const std::size_t count = (world.size() + block_size - 1) / block_size;
  plain_.resize((world.size() + 3) / 4);
  blocks_.resize(count);
  states_.resize(world.size());
  pairs_ = pairs.size();
  for (SpherePair& p : pairs)
    if (p.plane < 0 && p.b < p.a) std::swap(p.a, p.b), p.image = opposite_image(p.image);
  by_first_slot(pairs, world.size());
  const bool may_be_plain = has_plain_bodies(world);
  parallel_blocks(count, 1, [&](std::size_t i, std::size_t, std::size_t) {
    const std::size_t last = std::min(world.size(), (i + 1) * block_size);
    for (std::size_t s = i * block_size; s < last; ++s) {
      const double r = std::max(radius[s], 0.0);  // of others, which no pair names
      states_[s].position[3] = states_[s].spin[3] = r;
      states_[s].velocity[3] = world.inverse_mass[s];
      if (world.rotates()) states_[s].predicted[3] = world.inverse_inertia[s].x();
      if (s % 4 == 0) plain_[s / 4] = may_be_plain && are_plain(world, s);
    }
    const Slot begin = first_[i * block_size], end = first_[last];
    fill_block({pairs.data() + begin, pairs.data() + end}, static_cast<Slot>(i), friction, world.cell.has_value());
  });
  address_records();
}

/// pairs: those the block owns, by A.
void SphereBlocks::fill_block(std::span<SpherePair> pairs, Slot index, bool friction, bool periodic) {
  Block& block = blocks_[index];
  block.runs.clear(), block.pairs.clear(), block.images.clear(), block.incoming.clear();
  for (auto run = pairs.begin(); run != pairs.end();) {
    const auto end = std::find_if(run, pairs.end(), [a = run->a](const SpherePair& p) { return p.a != a; });
    std::sort(run, end, [](const SpherePair& p, const SpherePair& q) {
      return std::pair(p.b, p.image >> 8) < std::pair(q.b, q.image >> 8);
    });
    run = end;
  }
  RunWriter writer(block, periodic);
  for (std::size_t plane = 0; plane < planes_.size(); ++plane) {
    const auto p = static_cast<std::int32_t>(plane);
    writer.open(p, false);
    for (const SpherePair& pair : pairs)
      if (pair.plane == p) writer.add(pair);
    writer.close();
  }
  for (const bool across : {false, true}) {
    writer.open(-1, across);
    for (const SpherePair& pair : pairs)
      if (pair.plane < 0 && (pair.b / block_size != index) == across) writer.add(pair);
    writer.close();
  }
  block.springs.assign(friction ? block.pairs.size() : 0, SphereSpring{});
  block.touched.assign(block.pairs.size() / pairs_per_byte, 0);
  if (!block.pairs.empty()) block.pairs.resize(block.pairs.size() + pairs_ahead, block.pairs.back());
}

/// Gives every pair across blocks a place in `records`, and tells the block of its B.
void SphereBlocks::address_records() {
  std::uint32_t record = 0;
  for (Block& block : blocks_) {
    if (block.runs.empty() || !block.runs.back().across) continue;
    const Run& run = block.runs.back();
    block.record = record;
    for (std::uint32_t k = run.begin; k < run.end; ++k, ++record) {
      const Slot b = block.pairs[k].b.slot();
      blocks_[b / block_size].incoming.emplace_back(record, b);
    }
  }
  records_.assign(record, SphereSum{});
}

// --- springs on their way from one layout to the next

std::vector<SphereBlocks::Kept> SphereBlocks::springs() const {
  std::vector<Kept> kept;
  each_touching([&](const Block& block, const Run& run, std::uint32_t k) {
    if (block.springs.empty()) return;
    const Lanes& load = block.springs[k].load;
    const Slot b = run.plane >= 0 ? planes_[static_cast<std::size_t>(run.plane)].slot : block.pairs[k].b.slot();
    kept.push_back({block.pairs[k].a.slot(),
                    b,
                    block.images.empty() ? 0u : block.images[k].key,
                    {load[0], load[1], load[2], load[3]}});
  });
  return kept;
}

void SphereBlocks::restore(std::vector<Kept>& kept, std::size_t slots) {
  by_first_slot(kept, slots);
  parallel_blocks(blocks_.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    Block& block = blocks_[i];
    for (const Run& run : block.runs)
      for (std::uint32_t k = run.begin; k < run.end; ++k) {
        const Slot a = block.pairs[k].a.slot();
        const Slot b = run.plane >= 0 ? planes_[static_cast<std::size_t>(run.plane)].slot : block.pairs[k].b.slot();
        const std::uint32_t key = block.images.empty() ? 0u : block.images[k].key;
        const auto end = kept.begin() + first_[a + 1];
        const auto at =
            std::find_if(kept.begin() + first_[a], end, [b, key](const Kept& s) { return s.b == b && s.key == key; });
        if (at == end) continue;
        block.springs[k].load = Lanes{at->load[0], at->load[1], at->load[2], at->load[3]};
        block.touched[k / pairs_per_byte] |= static_cast<std::uint8_t>(1u << (k % pairs_per_byte));
      }
  });
}

void SphereBlocks::reorder(const Reordering& change) {
  std::fill(plain_.begin(), plain_.end(), std::uint8_t{0});
  if (laid_out_) kept_ = springs(), laid_out_ = false;
  std::vector<bool> is_plane(change.new_slot.size(), false);
  for (SpherePlane& p : planes_) is_plane[p.slot] = true, p.slot = change.new_slot[p.slot];
  std::vector<Kept> moved;
  for (Kept s : kept_) {
    const bool plane = is_plane[s.b];
    s.a = change.new_slot[s.a], s.b = change.new_slot[s.b];
    if (s.a == no_slot || s.b == no_slot) continue;
    if (!plane && s.b < s.a) {  // the load is that on the lower slot
      std::swap(s.a, s.b), s.key = opposite_image(s.key << 8) >> 8;
      for (int k = 0; k < 3; ++k) s.load[k] = -s.load[k];
    }
    moved.push_back(s);
  }
  kept_ = std::move(moved);
  for (Block& block : blocks_) {
    block.runs.clear(), block.pairs.clear(), block.images.clear(), block.springs.clear(), block.touched.clear();
    block.incoming.clear();
  }
}

void SphereBlocks::visit(StateVisitor& visitor) {
  std::fill(plain_.begin(), plain_.end(), std::uint8_t{0});  // it may be another state that comes in
  if (laid_out_) kept_ = springs(), laid_out_ = false;
  std::vector<Slot> a, b;
  std::vector<std::uint32_t> key;
  std::vector<double> values;
  for (const Kept& s : kept_) {
    a.push_back(s.a), b.push_back(s.b), key.push_back(s.key);
    values.insert(values.end(), s.load, s.load + 4);
  }
  visitor.column("spheres/a", a), visitor.column("spheres/b", b), visitor.column("spheres/key", key);
  visitor.column("spheres/spring", values);
  kept_.clear();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double* v = values.data() + 4 * i;
    kept_.push_back({a[i], b[i], key[i], {v[0], v[1], v[2], v[3]}});
  }
}

void SphereBlocks::receive(std::size_t i) {
  SphereSum* const mine = sums(i);
  for (const auto& [record, slot] : blocks_[i].incoming) {
    SphereSum& sum = mine[slot % block_size];
    sum.force += records_[record].force;
    sum.pull += records_[record].pull;
  }
}

}  // namespace epafi
