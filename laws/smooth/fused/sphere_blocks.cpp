#include "laws/smooth/fused/sphere_blocks.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <tuple>
#include <utility>

#include "engine/threads/parallel_order.h"
#include "engine/threads/parallel_wavefront.h"
#include "engine/units/error.h"
#include "laws/smooth/fused/body_pass.h"

namespace epafi {

namespace {

/// Which contacts of a block touch, by run and in the order of the pairs.
class Carried {
 public:
  using Block = SphereBlocks::Block;

  /// planes: those of the block's layout.
  void take(const Block& block, const std::vector<SpherePlane>& planes) {
    runs_.clear();
    contacts_.clear();
    const SphereBlocks::Run* last = nullptr;
    SphereBlocks::each_touching(block, [&](const SphereBlocks::Run& run, std::uint32_t k, std::uint32_t rank) {
      if (last != &run) {
        runs_.push_back({rank, rank, plane_slot(run, planes), run.across});
        last = &run;
      }
      contacts_.push_back({block.pairs[k], block.images.empty() ? 0u : block.images[k].key});
      runs_.back().end = rank + 1;
    });
  }
  /// Finds them among the pairs of the next layout, which has them in the same order.
  template <class BlockOf>
  void give(Block& block, const std::vector<SpherePlane>& planes, const BlockOf& block_of) {
    from_.clear();
    for (const SphereBlocks::Run& run : block.runs) {
      const Slot plane = plane_slot(run, planes);
      for (const Run& old : runs_)
        if (old.plane == plane && old.across == run.across) give(block, run, old, block_of);
    }
    block.springs.choose(from_);
  }

 private:
  struct Run {
    std::uint32_t begin, end;
    Slot plane;
    bool across;
  };
  struct Contact {
    SpherePlaces pair;
    std::uint32_t key;
  };
  static Slot plane_slot(const SphereBlocks::Run& run, const std::vector<SpherePlane>& planes) {
    return run.plane >= 0 ? planes[static_cast<std::size_t>(run.plane)].slot : no_slot;
  }
  template <class BlockOf>
  void give(Block& block, const SphereBlocks::Run& run, const Run& old, const BlockOf& block_of) {
    const auto order = [&](const Contact& c) {
      return std::tuple(block_of(c.pair.b.slot()), c.pair.a.offset, c.pair.b.offset, c.key);
    };
    std::uint32_t at = old.begin;
    for (std::uint32_t k = run.begin; k < run.end && at < old.end; ++k) {
      const Contact now{block.pairs[k], block.images.empty() ? 0u : block.images[k].key};
      while (at < old.end && order(contacts_[at]) > order(now)) ++at;
      if (at == old.end || order(contacts_[at]) != order(now)) continue;
      from_.push_back(at);
      block.set_touching(k);
    }
  }

  std::vector<Run> runs_;
  std::vector<Contact> contacts_;
  std::vector<std::uint32_t> from_;  ///< their numbers, as they come now
};

SphereImage image_of(std::uint32_t image) {
  const auto step = [&](int k) { return static_cast<double>(image_step(image >> k)); };
  return {Lanes{step(0), step(2), step(4), 0.0}, image >> 8};
}

/// Largest number of blocks per thread that are reordered. (Two threads, ns for contacts without and with reordering:
/// hopper of 20 blocks 30.9, 29.4; bed of 98 blocks, whose neighbours' bodies are in cache, 22.1, 25.8.)
constexpr std::size_t most_ordered = 16;
}  // namespace

// --- layout

void SphereBlocks::rebuild(const World& world, const SphereList& list) {
  const SpherePairs& pairs = list.pairs;
  EPAFI_REQUIRE(world.size() + list.balls.size() < most_bodies, "the loop over spheres addresses 67 million bodies");
  [[maybe_unused]] const std::size_t places = world.size() + list.balls.size();
  EPAFI_REQUIRE(pairs.first.size() > places && pairs.first.size() <= places + 2,
                "pairs are laid out from a list that is there, of these balls");
  if (!std::ranges::equal(list.balls, balls_.all())) {  // places are others
    take_out(planes_);
    grouped_ = false;
    balls_.take(list.balls, world);
  }
  has_new_balls_ = !balls_.empty() && balls_.use(pairs);
  const std::vector<SpherePlane> before = std::exchange(planes_, list.planes);
  const bool same_planes = std::ranges::equal(before, planes_, {}, &SpherePlane::slot, &SpherePlane::slot);
  const bool grown = laid_out_ && world.size() > laid_bodies_;
  bodies_ = world.size();
  const std::size_t count = ball_blocks() + blocks_of(bodies_);
  late_spins_.resize(needs_.damps_slip() ? balls_.size() + bodies_ : 0);
  pairs_ = pairs.size();
  if (!laid_out_) {
    name_places();
    group_kept(count);
  }
  blocks_.resize(count, Block(needs_));
  const std::size_t laid = laid_out_ && same_planes && !rows_.first.empty() ? balls_.size() + laid_bodies_ : 0;
  const auto relay = [&](std::size_t i) {
    thread_local Carried carried;
    const std::size_t end = end_of(i);
    if (end <= laid && keeps_rows(i, end, pairs)) return fill_pairs(blocks_[i]);
    const bool carries = laid_out_ && needs_.remembers();
    if (carries) carried.take(blocks_[i], before);
    lay_out(blocks_[i], static_cast<Slot>(i), pairs);
    if (carries)
      carried.give(blocks_[i], planes_, [this](Slot place) { return block_of(place); });
    else if (needs_.remembers())
      restore(blocks_[i], static_cast<Slot>(begin_of(i)),
              std::span(kept_.springs).subspan(kept_begin_[i], kept_begin_[i + 1] - kept_begin_[i]));
  };
  parallel_blocks(count, 1, [&](std::size_t i, std::size_t, std::size_t) { relay(i); });
  release(kept_.springs);
  laid_out_ = true;
  see_rows(pairs, grown);
  kept_.each_more(needs_, [](auto& column, const char*) { release(column); });
  list_sources();
}

/// The bodies of a block have the partners that they had at the last layout.
bool SphereBlocks::keeps_rows(std::size_t index, std::size_t end, const SpherePairs& pairs) const {
  const std::size_t begin = begin_of(index);
  const std::uint32_t now = pairs.first[begin], then = rows_.first[begin];
  for (std::size_t s = begin; s <= end; ++s)
    if (pairs.first[s] - now != rows_.first[s] - then) return false;
  return std::equal(pairs.partner.begin() + now, pairs.partner.begin() + pairs.first[end],
                    rows_.partner.begin() + then);
}

/// If bodies enter, many blocks do not change in the next layout.
void SphereBlocks::see_rows(const SpherePairs& pairs, bool grown) {
  const bool wanted = (grown || !rows_.first.empty()) && pairs.image.empty();
  laid_bodies_ = bodies_;
  if (!wanted) {
    release(rows_.first);
    return release(rows_.partner);
  }
  rows_.first.assign(pairs.first.begin(),
                     pairs.first.begin() + static_cast<std::ptrdiff_t>(balls_.size() + bodies_ + 1));
  rows_.partner.assign(pairs.partner.begin(), pairs.partner.begin() + rows_.first.back());
}

void SphereBlocks::welcome(const World& world) {
  bodies_ = world.size();
  plain_.resize((bodies_ + 3) / 4);
  std::fill(plain_.begin() + static_cast<std::ptrdiff_t>(laid_bodies_ / 4), plain_.end(), std::uint8_t{0});
  late_spins_.resize(needs_.damps_slip() ? balls_.size() + bodies_ : 0);
}

void SphereBlocks::set_constants(World& world, std::span<const double> radius, std::size_t first) {
  plain_.resize((world.size() + 3) / 4);
  const bool may_be_plain = has_plain_bodies(world);
  const std::span<BodyState> states = world.states();
  parallel_for(
      plain_.size() - first / 4,
      [&](std::size_t k) {
        const std::size_t four = first / 4 + k;
        plain_[four] = may_be_plain ? plainness(world, 4 * four) : std::uint8_t{0};
        for (std::size_t s = std::max(first, 4 * four); s < std::min(world.size(), 4 * four + 4); ++s) {
          states[s].position[3] = states[s].spin[3] = radius[s - first];
          if (world.columns().anisotropy) states[s].predicted[3] = world.inverse_inertia_of(static_cast<Slot>(s)).x();
          if (balls_.size() + s < late_spins_.size()) late_spins_[balls_.size() + s][3] = states[s].predicted[3];
        }
      },
      128);
}

/// end: of the places of a block; b: a partner of one of them.
std::size_t SphereBlocks::run_of(Slot b, std::size_t end) const {
  if ((b & SpherePairs::plane) != 0) return b & ~SpherePairs::plane;
  return planes_.size() + (b < end ? 0 : 1);
}

/// Finds the runs of a block and the later blocks among its partners. place: by run, index of its first pair; pairs_end
/// of a target holds the same until its pairs are written.
void SphereBlocks::make_runs(Block& block, std::size_t end, std::span<const Slot> partners,
                             std::vector<std::uint32_t>& place) const {
  const std::size_t inside = planes_.size(), across = inside + 1;
  thread_local std::vector<std::uint32_t> count_for;  // by later block, all 0 but within this call
  place.assign(across + 1, 0);
  count_for.resize(blocks_.size());
  block.runs.clear();
  block.targets.clear();
  block.size = 0;
  for (const Slot b : partners) {
    const std::size_t run = run_of(b, end);
    ++place[run];
    if (run != across) continue;
    const std::size_t target = block_of(b);
    if (count_for[target]++ == 0) block.targets.push_back({static_cast<Slot>(target)});
  }
  for (std::size_t r = 0; r <= across; ++r) {
    const std::size_t run = r < inside ? r : across + inside - r;  // those across before those inside
    const std::uint32_t count = std::exchange(place[run], block.size);
    if (count == 0) continue;
    const std::int32_t plane = run < inside ? static_cast<std::int32_t>(run) : -1;
    block.runs.push_back({block.size, block.size + count, plane, run == across});
    block.size += (count + pairs_per_byte - 1) / pairs_per_byte * pairs_per_byte;
  }
  std::ranges::sort(block.targets, std::ranges::greater{}, &Target::block);
  std::uint32_t next = place[across];
  for (Target& t : block.targets) {
    t.pairs_end = next;
    next += std::exchange(count_for[t.block], 0u);
  }
}

/// Pairs go to their runs in the order of their bodies, those across blocks by the block of their B.
void SphereBlocks::lay_out(Block& block, Slot index, const SpherePairs& pairs) {
  const std::size_t begin = begin_of(index), end = end_of(index);
  const std::size_t inside = planes_.size(), across = inside + 1;
  const std::uint32_t first = pairs.first[begin], count = pairs.first[end] - first;
  thread_local std::vector<std::uint32_t> place;
  make_runs(block, end, std::span(pairs.partner).subspan(first, count), place);
  renew(block.pairs, block.size + pairs_ahead, 16);
  if (!pairs.image.empty()) renew(block.images, block.size, 16);
  for (std::size_t s = end; s-- > begin;)
    for (std::uint32_t k = pairs.first[s + 1]; k-- > pairs.first[s];) {
      const Slot b = pairs.partner[k];
      const std::size_t run = run_of(b, end);
      const std::uint32_t at = run == across ? target_of(block, block_of(b))->pairs_end++ : place[run]++;
      block.pairs[at] = {SpherePlace(static_cast<Slot>(s)),
                         SpherePlace(run < inside ? place_of_body(planes_[run].slot) : b)};
      if (!block.images.empty()) block.images[at] = image_of(pairs.image[k]);
    }
  block.targets.push_back({no_slot, std::numeric_limits<std::uint32_t>::max()});
  fill_up(block);
}

/// Pads runs to multiples of eight, and the block by the prefetch distance.
void SphereBlocks::fill_up(Block& block) const {
  fill_pairs(block);
  for (std::size_t r = 0; r < block.runs.size() && !block.images.empty(); ++r) {
    const std::uint32_t last = block.runs[r].end,
                        next = r + 1 < block.runs.size() ? block.runs[r + 1].begin : block.size;
    std::fill(block.images.begin() + last, block.images.begin() + next, block.images[last - 1]);
  }
  block.touched.assign(block.size / pairs_per_byte, 0);
}

/// The NaN state follows the last body.
void SphereBlocks::fill_pairs(Block& block) const {
  const SpherePlace nowhere(place_of_body(static_cast<Slot>(bodies_)));
  for (std::size_t r = 0; r < block.runs.size(); ++r) {
    const std::uint32_t last = block.runs[r].end,
                        next = r + 1 < block.runs.size() ? block.runs[r + 1].begin : block.size;
    std::fill(block.pairs.begin() + last, block.pairs.begin() + next, SpherePlaces{nowhere, nowhere});
  }
  std::fill(block.pairs.begin() + block.size, block.pairs.end(), SpherePlaces{nowhere, nowhere});
}

void SphereBlocks::list_sources() {
  for (Block& block : blocks_) {
    block.sources.clear();
    block.waits.clear();
  }
  const std::size_t of_balls = ball_blocks(), of_bodies = blocks_.size() - of_balls;
  for (Slot i = 0; i < blocks_.size(); ++i)
    for (const Target& t : blocks_[i].targets) {
      if (t.block == no_slot) continue;
      blocks_[t.block].sources.push_back(i);
      if (t.block < of_balls)
        blocks_[t.block].waits.push_back(i);
      else if (i >= of_balls)
        blocks_[t.block].waits.push_back(static_cast<std::uint32_t>(i - of_balls));
    }
  const auto threads = static_cast<std::size_t>(thread_count());
  order_.clear();
  if (threads > 1 && of_bodies <= most_ordered * threads)
    order_wavefront(
        of_bodies, threads, [&](std::size_t i) -> const auto& { return blocks_[of_balls + i].waits; }, order_);
}

void SphereBlocks::Block::grow_records(std::size_t size, bool rolls) {
  const auto grow = [room = size + size / 16](auto& column) {
    column.reserve(room);
    column.resize(room);
  };
  grow(records);
  grow(record_places);
  if (rolls) grow(record_moments);
}

// --- springs on their way from one layout to the next

SphereBlocks::Kept SphereBlocks::kept_of(const Block& block, const Run& run, std::uint32_t k, std::uint32_t rank,
                                         const std::vector<SpherePlane>& planes) const {
  const Lanes load = needs_.friction ? block.springs.friction(rank).load : Lanes{};
  const std::uint32_t image = block.images.empty() ? 0u : block.images[k].key;
  const bool wall = run.plane >= 0;
  const Slot a = block.pairs[k].a.slot(), b = block.pairs[k].b.slot();
  const std::uint32_t key = image | balls_.part_of(a) << 8;
  return {balls_.body_of(a),
          wall ? planes[static_cast<std::size_t>(run.plane)].slot : balls_.body_of(b),
          wall ? key | Kept::of_plane : key | balls_.part_of(b) << 16,
          0,
          {load[0], load[1], load[2], load[3]}};
}

/// The same spring seen from B: the memory is the load on A.
void SphereBlocks::turn_round(Kept& kept) {
  std::swap(kept.a, kept.b);
  kept.key = opposite_image((kept.key & Kept::image) << 8) >> 8 | (kept.key >> 8 & 0xffu) << 16 |
             (kept.key >> 16 & 0xffu) << 8;
  for (int k = 0; k < 3; ++k) kept.load[k] = -kept.load[k];
  for (std::size_t k = 0; needs_.rolling && k < 3; ++k) kept_.rolling[kept.more][k] *= -1.0;
  if (needs_.bristles) exchange(kept_.bristles[kept.more].get());
}

/// Renumbers kept springs to places of the next layout, the lower one first.
void SphereBlocks::name_places() {
  if (std::exchange(kept_of_balls_, false) == false && balls_.empty()) return;
  for (Kept& s : kept_.springs) {
    const bool wall = (s.key & Kept::of_plane) != 0;
    s.a = balls_.place_of(s.a, s.key >> 8 & 0xffu);
    s.b = wall ? place_of_body(s.b) : balls_.place_of(s.b, s.key >> 16 & 0xffu);
    if (s.a == no_slot || s.b == no_slot) continue;
    if (!wall && s.a > s.b) turn_round(s);
    s.key &= Kept::image | Kept::of_plane;
  }
  std::erase_if(kept_.springs, [](const Kept& s) { return s.a == no_slot || s.b == no_slot; });
  grouped_ = false;
}

/// kept: springs of a block whose first place is `first`.
void SphereBlocks::restore(Block& block, Slot first, std::span<const Kept> kept) {
  std::array<std::uint32_t, largest_block + 2> begin{};
  for (const Kept& s : kept) ++begin[s.a - first + 2];
  for (std::size_t s = 1; s < begin.size(); ++s) begin[s] += begin[s - 1];
  thread_local std::vector<const Kept*> by_a, found;
  thread_local std::vector<std::uint32_t> fresh;
  found.clear();
  by_a.resize(kept.size());
  for (const Kept& s : kept) by_a[begin[s.a - first + 1]++] = &s;
  for (const Run& run : block.runs)
    for (std::uint32_t k = run.begin; k < run.end; ++k) {
      const Slot a = block.pairs[k].a.slot() - first;
      const Slot b = block.pairs[k].b.slot();
      const std::uint32_t key = block.images.empty() ? 0u : block.images[k].key;
      const auto end = by_a.begin() + begin[a + 1];
      const auto at = std::find_if(by_a.begin() + begin[a], end,
                                   [b, key](const Kept* s) { return s->b == b && (s->key & ~Kept::of_plane) == key; });
      if (at == end) continue;
      found.push_back(*at);
      block.set_touching(k);
    }
  fresh.assign(found.size(), SphereSprings::fresh);
  block.springs.choose(fresh);
  for (std::uint32_t rank = 0; rank < found.size(); ++rank) {
    const double* load = found[rank]->load;
    if (needs_.friction) block.springs.friction(rank).load = Lanes{load[0], load[1], load[2], load[3]};
    const std::uint32_t more = found[rank]->more;
    if (needs_.normal) block.springs.normal(rank) = kept_.normal[more];
    if (needs_.push) block.springs.push(rank) = kept_.push[more];
    if (needs_.bristles) block.springs.bristles(rank) = kept_.bristles[more];
    if (!needs_.rolling) continue;
    const Load& moment = kept_.rolling[more];
    block.springs.rolling(rank).load = Lanes{moment[0], moment[1], moment[2], moment[3]};
  }
}

/// Moves springs out of the blocks, in order; planes: those of the layout.
void SphereBlocks::take_out(const std::vector<SpherePlane>& planes) {
  if (!laid_out_) return;
  kept_of_balls_ = !balls_.empty();
  kept_begin_.assign(blocks_.size() + 1, 0);
  const auto count = [&](std::size_t i) { kept_begin_[i + 1] = blocks_[i].springs.count(); };
  if (needs_.remembers()) parallel_for(blocks_.size(), count, 1);
  running_sums(kept_begin_);
  const std::size_t touching = kept_begin_.back();
  kept_.springs.resize(touching);
  kept_.each_more(needs_, [&](auto& column, const char*) { column.resize(touching); });
  const auto take = [&](std::size_t i) {
    std::uint32_t at = kept_begin_[i];
    const SphereSprings& springs = blocks_[i].springs;
    if (needs_.remembers())
      each_touching(blocks_[i], [&](const Run& run, std::uint32_t k, std::uint32_t rank) {
        kept_.springs[at] = kept_of(blocks_[i], run, k, rank, planes);
        kept_.springs[at].more = at;
        if (needs_.normal) kept_.normal[at] = springs.normal(rank);
        if (needs_.push) kept_.push[at] = springs.push(rank);
        if (needs_.bristles) kept_.bristles[at] = springs.bristles(rank);
        if (needs_.rolling) std::memcpy(kept_.rolling[at].data(), &springs.rolling(rank).load, sizeof(Load));
        ++at;
      });
    blocks_[i].runs.clear();
    blocks_[i].springs = SphereSprings(needs_);
  };
  laid_out_ = false;
  grouped_ = true;
  parallel_blocks(blocks_.size(), 1, [&](std::size_t i, std::size_t, std::size_t) { take(i); });
}

/// Brings the springs of a block together, in place (McIlroy, Bostic and McIlroy 1993): kept_begin_ says where.
void SphereBlocks::group_kept(std::size_t count) {
  if (grouped_ && kept_begin_.size() == count + 1) return;
  UnwrittenColumn<Kept>& kept = kept_.springs;
  kept_begin_.assign(count + 1, 0);
  const auto block = [this](const Kept& s) { return block_of(s.a); };
  const bool in_order = block_max<char>(std::max(kept.size(), std::size_t{1}) - 1, 0, [&](std::size_t k) {
                          return static_cast<char>(block(kept[k]) > block(kept[k + 1]));
                        }) == 0;
  if (in_order)  // as they were taken out, unless bodies went to other slots
    return parallel_for(
        count + 1,
        [&](std::size_t i) {
          const auto at = std::ranges::lower_bound(kept, i, {}, block);
          kept_begin_[i] = static_cast<std::uint32_t>(at - kept.begin());
        },
        1);
  for (const Kept& s : kept) ++kept_begin_[block(s) + 1];
  for (std::size_t i = 0; i < count; ++i) kept_begin_[i + 1] += kept_begin_[i];
  std::vector<std::uint32_t> next(kept_begin_.begin(), kept_begin_.end() - 1);
  for (std::size_t i = 0; i < count; ++i)
    while (next[i] < kept_begin_[i + 1]) {
      const std::size_t home = block(kept[next[i]]);
      if (home == i)
        ++next[i];
      else
        std::swap(kept[next[i]], kept[next[home]++]);
    }
}

void SphereBlocks::reorder(const Reordering& change) {
  std::fill(plain_.begin(), plain_.end(), std::uint8_t{0});
  take_out(planes_);
  grouped_ = false;
  balls_.forget_places();
  for (SpherePlane& p : planes_) p.slot = change.new_slot[p.slot];
  for (Kept& s : kept_.springs) {
    s.a = change.new_slot[s.a];
    s.b = change.new_slot[s.b];
    // planes are not known yet after a state was loaded
    if (s.a == no_slot || s.b == no_slot || (s.key & Kept::of_plane) != 0 || s.a < s.b) continue;
    turn_round(s);  // the load is that on the lower slot
  }
  std::erase_if(kept_.springs, [](const Kept& s) { return s.a == no_slot || s.b == no_slot; });
}

void SphereBlocks::visit(StateVisitor& visitor) {
  std::fill(plain_.begin(), plain_.end(), std::uint8_t{0});  // the loaded state may differ
  take_out(planes_);
  grouped_ = false;
  balls_.forget_places();
  // other memory is in the order of the remaining springs
  kept_.each_more(needs_, [&]<class T>(UnwrittenColumn<T>& column, const char*) {
    UnwrittenColumn<T> left;
    left.reserve(kept_.springs.size());
    for (const Kept& s : kept_.springs) left.push_back(column[s.more]);
    column.swap(left);
  });
  const auto number = [&] {
    for (std::uint32_t i = 0; i < kept_.springs.size(); ++i) kept_.springs[i].more = i;
  };
  number();
  visitor.rows(RowsOf::pairs, "spheres/springs",
               kept_.springs);  // as they are: a copy by columns took 82 bytes a sphere
  number();
  kept_.each_more(needs_, [&](auto& column, const char* name) {
    visitor.rows(RowsOf::contacts, name, column);
    const std::size_t known = column.size();  // fewer where the law did not remember this before
    column.resize(kept_.springs.size());
    if (known < column.size())
      std::fill(column.begin() + known, column.end(), typename std::decay_t<decltype(column)>::value_type{});
  });
}

}  // namespace epafi
