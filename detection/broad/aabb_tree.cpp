#include "detection/broad/aabb_tree.h"

#include <algorithm>
#include <cmath>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {
constexpr std::uint32_t leaf_size = 8;  // bodies; 4 and 16 are slower in perf/broad.cpp
constexpr double mixed_sizes = 4.0;     // largest over smallest in a node, above which it is split by size
constexpr double rebuilt_at = 1.2;      // surface over that when built, above which the tree is built anew
constexpr std::size_t leaves_per_block = 64;

double half_surface(const Aabb& b) {
  const Vec3 e = b.extent();
  return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
}
}  // namespace

void AabbTree::build(const FatBodies& bodies) {
  slot_ = bodies.ordinary;
  node_.clear();
  leaf_.clear();
  if (!slot_.empty()) split(bodies, 0, static_cast<std::uint32_t>(slot_.size()));
  ++builds_;
}

std::uint32_t AabbTree::partition(const FatBodies& bodies, std::uint32_t first, std::uint32_t count) {
  const auto begin = slot_.begin() + first, end = begin + count;
  double least = infinity, most = 0.0;
  Aabb centres;
  for (auto s = begin; s != end; ++s) {
    least = std::min(least, bodies.half_of(*s));
    most = std::max(most, bodies.half_of(*s));
    centres.include(bodies.position(*s));
  }
  if (most > mixed_sizes * least) {
    const double limit = most / mixed_sizes;
    const auto middle = std::partition(begin, end, [&](Slot s) { return bodies.half_of(s) > limit; });
    return static_cast<std::uint32_t>(middle - begin);
  }
  int axis = 0;
  centres.extent().maxCoeff(&axis);
  const auto middle = begin + count / 2;
  std::nth_element(begin, middle, end, [&](Slot p, Slot q) {
    const double x = bodies.position(p)[axis], y = bodies.position(q)[axis];
    return x != y ? x < y : p < q;
  });
  return count / 2;
}

void AabbTree::split(const FatBodies& bodies, std::uint32_t first, std::uint32_t count) {
  const auto node = static_cast<std::uint32_t>(node_.size());
  node_.push_back({{}, 0, first, count});
  if (count <= leaf_size) {
    leaf_.push_back(node);
    return;
  }
  const std::uint32_t left = partition(bodies, first, count);
  split(bodies, first, left);
  node_[node].right = static_cast<std::uint32_t>(node_.size());
  split(bodies, first + left, count - left);
}

void AabbTree::refit(const FatBodies& bodies) {
  const std::size_t n = slot_.size();
  box_.resize(n);
  ball_.resize(n);
  parallel_for(n, [&](std::size_t k) {
    const Slot s = slot_[k];
    box_[k] = bodies.box(s);
    ball_[k] = bodies.ball[s];
  });
  for (std::size_t i = node_.size(); i-- > 0;) {  // children stand behind their parents
    Node& node = node_[i];
    node.box = {};
    if (node.right != 0) {
      node.box.include(node_[i + 1].box);
      node.box.include(node_[node.right].box);
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) node.box.include(box_[k]);
  }
}

double AabbTree::surface() const {
  return block_sum<double>(node_.size(), [&](std::size_t i) { return half_surface(node_[i].box); });
}

void AabbTree::find_leaves(const Aabb& box, Scratch& scratch) const {
  auto& [stack, leaves, found] = scratch;
  leaves.clear();
  stack.assign(1, 0);
  while (!stack.empty()) {
    const std::uint32_t i = stack.back();
    stack.pop_back();
    const Node& node = node_[i];
    if (!node.box.overlaps(box)) continue;
    if (node.right == 0)
      leaves.push_back(i);
    else {
      stack.push_back(node.right);
      stack.push_back(i + 1);
    }
  }
}

void AabbTree::collect(const FatBodies& bodies, PairCollector& collector) {
  // the same set of bodies in the same slots: the tree is kept
  if (slots_changed() || slot_.size() != bodies.ordinary.size()) node_.clear();
  bool fresh = node_.empty();
  if (fresh) build(bodies);
  refit(bodies);
  if (!fresh && surface() > rebuilt_at * surface_when_built_) {
    build(bodies);
    refit(bodies);
    fresh = true;
  }
  if (fresh) surface_when_built_ = surface();
  const std::size_t blocks = (leaf_.size() + leaves_per_block - 1) / leaves_per_block;
  collector.begin(blocks);
  if (scratch_.size() < blocks) scratch_.resize(blocks);
  parallel_blocks(leaf_.size(), leaves_per_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
    Scratch& mine = scratch_[block];
    for (std::size_t l = begin; l < end; ++l) {
      const Node& leaf = node_[leaf_[l]];
      find_leaves(leaf.box, mine);
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        mine.found.clear();
        for (std::uint32_t other : mine.leaves) {
          const Node& o = node_[other];
          if (!o.box.overlaps(box_[i])) continue;
          for (std::uint32_t k = o.first; k < o.first + o.count; ++k)
            if (slot_[k] > slot_[i] && ball_[i].overlaps(ball_[k])) mine.found.push_back(slot_[k]);
        }
        collector.add(block, slot_[i], mine.found);
      }
    }
  });
}

}  // namespace epafi
