#include "laws/smooth/fused/sphere_blocks.h"

#include <algorithm>

#include "engine/parallel.h"

namespace epafi {
namespace {

constexpr std::size_t lanes_size = lane_count;

SphereGroup empty_group(Slot slot, std::int32_t plane) {
  SphereGroup g{};
  g.radius_sum = lanes(-1.0), g.radius = lanes(1.0), g.mass = lanes(1.0), g.normal_force = lanes(-1.0);
  for (int k = 0; k < lane_count; ++k) g.a[k] = g.b[k] = slot;
  g.plane = plane;
  return g;
}

/// Fills groups of four from contacts that share a plane (or none).
class GroupWriter {
 public:
  explicit GroupWriter(SphereBlocks::Block& block) : groups_(block.groups), images_(block.images) {}
  void add(const World& world, const SpherePair& p, std::span<const double> radius) {
    if (used_ == lane_count || groups_.empty() || plane_ != p.plane) {
      groups_.push_back(empty_group(p.a, p.plane));
      if (world.cell) images_.emplace_back();
      used_ = 0, plane_ = p.plane;
    }
    SphereGroup& g = groups_.back();
    if (world.cell) {
      SphereImages& image = images_.back();
      image.x[used_] = image_step(p.image), image.y[used_] = image_step(p.image >> 2),
      image.z[used_] = image_step(p.image >> 4), image.key[used_] = p.image >> 8;
    }
    const int k = used_++;
    const bool wall = p.plane >= 0;
    const double ra = radius[p.a], rb = wall ? 0.0 : radius[p.b];
    g.a[k] = p.a, g.b[k] = p.b;
    g.share[k] = wall ? 1.0 : ra / (ra + rb), g.radius_sum[k] = ra + rb;
    g.radius[k] = wall ? ra : 1.0 / (1.0 / ra + 1.0 / rb);
    g.mass[k] = 1.0 / (world.inverse_mass[p.a] + world.inverse_mass[p.b]);
  }
  /// The next contact opens a group of its own.
  void close() { used_ = lane_count; }

 private:
  std::vector<SphereGroup>& groups_;
  std::vector<SphereImages>& images_;
  int used_ = lane_count;
  std::int32_t plane_ = -2;
};

/// The same pair seen from B: both codes turn their sign.
std::uint32_t opposite_image(std::uint32_t image) {
  const auto turned = [](std::uint32_t code) {
    const auto bits = [code](int k) { return -static_cast<int>(code >> (2 * k) & 3u); };
    return image_code(bits(0), bits(1), bits(2));
  };
  return turned(image) | turned(image >> 8) << 8;
}

}  // namespace

// --- layout

void SphereBlocks::rebuild(const World& world, std::span<const SpherePair> pairs, std::vector<SpherePlane> planes,
                           std::span<const double> radius) {
  std::vector<Kept> kept = laid_out_ ? springs() : std::move(kept_);
  kept_.clear(), laid_out_ = true;
  planes_ = std::move(planes);
  place(world, pairs, radius);
  restore(kept, world.size());
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

void SphereBlocks::place(const World& world, std::span<const SpherePair> pairs, std::span<const double> radius) {
  const std::size_t count = (world.size() + block_size - 1) / block_size;
  blocks_.resize(count);
  pairs_ = pairs.size();
  sorted_.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sorted_[i] = pairs[i];
    if (SpherePair& p = sorted_[i]; p.plane < 0 && p.b < p.a)
      std::swap(p.a, p.b), p.image = opposite_image(p.image);
  }
  by_first_slot(sorted_, world.size());
  parallel_blocks(count, 1, [&](std::size_t i, std::size_t, std::size_t) {
    const Slot begin = first_[i * block_size], end = first_[std::min(world.size(), (i + 1) * block_size)];
    fill_block(world, {sorted_.data() + begin, sorted_.data() + end}, static_cast<Slot>(i), radius);
  });
  std::uint32_t record = 0;
  for (Block& block : blocks_)
    for (std::size_t g = block.across; g < block.groups.size(); ++g) {
      block.groups[g].record = record;
      for (std::size_t k = 0; k < lanes_size; ++k, ++record) {
        if (block.groups[g].radius_sum[static_cast<int>(k)] < 0) continue;
        blocks_[block.groups[g].b[k] / block_size].incoming.emplace_back(record, block.groups[g].b[k]);
      }
    }
  records_.assign(record, SphereSum{});
}

/// pairs: those the block owns, by A.
void SphereBlocks::fill_block(const World& world, std::span<SpherePair> pairs, Slot index,
                              std::span<const double> radius) {
  Block& block = blocks_[index];
  block.groups.clear(), block.images.clear(), block.incoming.clear();
  const auto kind = [&](const SpherePair& p) { return p.plane >= 0 ? 0 : p.b / block_size == index ? 1 : 2; };
  for (auto run = pairs.begin(); run != pairs.end();) {
    const auto end = std::find_if(run, pairs.end(), [a = run->a](const SpherePair& p) { return p.a != a; });
    std::sort(run, end, [](const SpherePair& p, const SpherePair& q) {
      return std::pair(p.b, p.image >> 8) < std::pair(q.b, q.image >> 8);
    });
    run = end;
  }
  std::vector<SpherePair> walls;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(walls), [](const SpherePair& p) { return p.plane >= 0; });
  std::stable_sort(walls.begin(), walls.end(),
                   [](const SpherePair& p, const SpherePair& q) { return p.plane < q.plane; });
  GroupWriter writer(block);
  for (const SpherePair& p : walls) writer.add(world, p, radius);
  block.inside = block.groups.size(), writer.close();
  for (const SpherePair& p : pairs)
    if (kind(p) == 1) writer.add(world, p, radius);
  block.across = block.groups.size(), writer.close();
  for (const SpherePair& p : pairs)
    if (kind(p) == 2) writer.add(world, p, radius);
}

std::vector<SphereBlocks::Kept> SphereBlocks::springs() const {
  std::vector<Kept> kept;
  for (const Block& block : blocks_)
    for (std::size_t i = 0; i < block.groups.size(); ++i)
      for (int k = 0; k < lane_count; ++k) {
        const SphereGroup& g = block.groups[i];
        if (g.normal_force[k] < 0.0) continue;
        const Slot b = g.plane >= 0 ? planes_[static_cast<std::size_t>(g.plane)].slot : g.b[k];
        kept.push_back({g.a[k],
                        b,
                        block.images.empty() ? 0u : block.images[i].key[k],
                        {g.load_x[k], g.load_y[k], g.load_z[k]},
                        g.stiffness[k],
                        g.energy[k],
                        g.viscous[k],
                        g.normal_force[k]});
      }
  return kept;
}

void SphereBlocks::restore(std::vector<Kept>& kept, std::size_t slots) {
  by_first_slot(kept, slots);
  parallel_blocks(blocks_.size(), 1, [&](std::size_t block, std::size_t, std::size_t) {
    const auto& images = blocks_[block].images;
    for (std::size_t i = 0; i < blocks_[block].groups.size(); ++i)
      for (int k = 0; k < lane_count; ++k) {
        SphereGroup& g = blocks_[block].groups[i];
        if (g.radius_sum[k] < 0) continue;
        const Slot b = g.plane >= 0 ? planes_[static_cast<std::size_t>(g.plane)].slot : g.b[k];
        const std::uint32_t key = images.empty() ? 0u : images[i].key[k];
        const auto end = kept.begin() + first_[g.a[k] + 1];
        const auto at = std::find_if(kept.begin() + first_[g.a[k]], end,
                                     [b, key](const Kept& s) { return s.b == b && s.key == key; });
        if (at == end) continue;
        g.load_x[k] = at->load[0], g.load_y[k] = at->load[1], g.load_z[k] = at->load[2];
        g.stiffness[k] = at->stiffness, g.energy[k] = at->energy, g.viscous[k] = at->viscous,
        g.normal_force[k] = at->normal_force;
        g.loaded = true;
      }
  });
}

void SphereBlocks::reorder(const Reordering& change) {
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
      for (double& x : s.load) x = -x;
    }
    moved.push_back(s);
  }
  kept_ = std::move(moved);
  for (Block& block : blocks_) block.groups.clear(), block.images.clear(), block.incoming.clear(), block.inside = block.across = 0;
}

void SphereBlocks::visit(StateVisitor& visitor) {
  if (laid_out_) kept_ = springs(), laid_out_ = false;
  std::vector<Slot> a, b;
  std::vector<std::uint32_t> key;
  std::vector<double> values;
  for (const Kept& s : kept_) {
    a.push_back(s.a), b.push_back(s.b), key.push_back(s.key);
    values.insert(values.end(), {s.load[0], s.load[1], s.load[2], s.stiffness, s.energy, s.viscous, s.normal_force});
  }
  visitor.column("spheres/a", a), visitor.column("spheres/b", b), visitor.column("spheres/key", key);
  visitor.column("spheres/spring", values);
  kept_.clear();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double* v = values.data() + 7 * i;
    kept_.push_back({a[i], b[i], key[i], {v[0], v[1], v[2]}, v[3], v[4], v[5], v[6]});
  }
}

void SphereBlocks::pack(const World& world, double lag) {
  states_.resize(world.size()), sums_.resize(world.size()), viscous_.resize(world.size());  // unpack leaves the sums at zero
  if (world.cell) virials_.resize(world.size());
  const bool rotates = world.rotates();
  static constexpr double still[3] = {0.0, 0.0, 0.0};
  parallel_blocks(world.size(), block_size, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto s = static_cast<Slot>(i);
      const double *x = world.position[s].data(), *v = world.velocity[s].data(),
                   *w = rotates ? world.angular_velocity[s].data() : still;
      double* to =
          reinterpret_cast<double*>(&states_[i]);  // number by number: a row of lanes would go through the stack
      for (int k = 0; k < 3; ++k) to[k] = x[k], to[4 + k] = v[k], to[8 + k] = w[k], to[12 + k] = v[k];
      if (lag == 0.0) continue;
      const Vec3 change = lag * world.acceleration(s);
      for (int k = 0; k < 3; ++k) to[12 + k] += change[k];
    }
  });
}

void SphereBlocks::unpack(World& world, bool add) {
  const bool rotates = world.rotates();
  parallel_blocks(blocks_.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    Block& block = blocks_[i];
    for (const auto& [record, slot] : block.incoming) {
      sums_[slot].force += records_[record].force;
      sums_[slot].torque += records_[record].torque;
    }
    block.stored = block.frictional = block.viscous = 0.0, block.virial.setZero();
    const std::size_t end = std::min(world.size(), (i + 1) * block_size);
    for (std::size_t s = i * block_size; s < end; ++s) {
      double* from = reinterpret_cast<double*>(&sums_[s]);
      double* force = world.force[s].data();
      for (int k = 0; k < 3; ++k) force[k] = add ? force[k] + from[k] : from[k];
      if (rotates) {
        double* torque = world.torque[s].data();
        for (int k = 0; k < 3; ++k) torque[k] = add ? torque[k] + from[4 + k] : from[4 + k];
      }
      block.stored += from[3], block.frictional += from[7], block.viscous += viscous_[s];
      viscous_[s] = 0.0;
      for (int k = 0; k < 8; ++k) from[k] = 0.0;
      if (!world.cell) continue;
      for (int k = 0; k < 3; ++k) block.virial[k] += virials_[s].sum[k];
      virials_[s].sum = Lanes{};
    }
  });
}

void SphereBlocks::publish(const World& world, ContactSet& contacts) const {
  contacts.force.resize(contacts.size());
  for (const Block& block : blocks_)
    for (std::size_t i = 0; i < block.groups.size(); ++i)
      for (int k = 0; k < lane_count; ++k) {
        const SphereGroup& g = block.groups[i];
        if (g.normal_force[k] < 0.0) continue;
        const bool wall = g.plane >= 0;
        const Slot a = g.a[k], b = wall ? planes_[static_cast<std::size_t>(g.plane)].slot : g.b[k];
        ContactPoint c;
        std::uint32_t key = 0;  // that of a plane follows the cells the sphere has passed: it is with the plane itself
        if (world.cell) key = wall ? image_code(world.wraps[a] - world.wraps[b]) : block.images[i].key[k];
        const Vec3 d = world.branch(a, b, Feature{key} << 56);
        double length = 0.0;
        if (wall) {
          const SpherePlane& plane = planes_[static_cast<std::size_t>(g.plane)];
          c.gap = plane.normal.dot(world.position[a] - plane.point) - g.radius_sum[k], c.normal = -plane.normal,
          length = g.radius_sum[k];
        } else {
          const double distance = d.norm();
          c.gap = distance - g.radius_sum[k], c.normal = distance > 0.0 ? Vec3(d / distance) : Vec3(Vec3::UnitZ()),
          length = g.share[k] * distance;
        }
        c.arm = length * c.normal;
        c.effective_radius = g.radius[k];
        Vec3 force = -g.normal_force[k] * c.normal + Vec3(g.load_x[k], g.load_y[k], g.load_z[k]);
        const bool in_order = world.id[a] < world.id[b];
        c.feature = Feature{in_order ? key : opposite_image(key << 8) >> 8} << 56;
        if (in_order) {
          contacts.append(a, b, c);
        } else {
          c.arm -= d;
          c.normal = -c.normal, force = -force;
          contacts.append(b, a, c);
        }
        contacts.force.resize(contacts.size());
        contacts.force.back() = force;
      }
}

}  // namespace epafi
