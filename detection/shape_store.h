/// @file shape_store.h  One column per shape type; bodies refer to a shape by type and index packed in 32 bits.
/// Bodies of equal shape share it: a hull's vertices are stored once per shape, not per body.
#pragma once
#include <tuple>
#include <vector>

#include "detection/shapes/all_shapes.h"
#include "engine/state/world.h"

namespace epafi {

/// Type in the top 5 bits, index below: up to 32 types of 134 million shapes each.
struct ShapeRef {
  static constexpr std::uint32_t index_bits = 27;
  std::uint32_t packed = 0;
  constexpr std::uint32_t type() const { return packed >> index_bits; }
  constexpr std::uint32_t index() const { return packed & ((1u << index_bits) - 1); }
};

template <class List>
class ShapeColumns;

template <class... S>
class ShapeColumns<ShapeList<S...>> {
 public:
  template <class T>
  static constexpr std::uint32_t type_of() {
    std::uint32_t k = 0, found = 0;
    ((std::is_same_v<T, S> ? void(found = k) : void(), ++k), ...);
    return found;
  }
  template <class T>
  ShapeRef add(T shape) {
    auto& column = std::get<std::vector<T>>(columns_);
    column.push_back(std::move(shape));
    return {type_of<T>() << ShapeRef::index_bits | static_cast<std::uint32_t>(column.size() - 1)};
  }
  template <class T>
  const std::vector<T>& of() const {
    return std::get<std::vector<T>>(columns_);
  }

  /// f(shape) with the concrete type behind the reference.
  template <class F>
  decltype(auto) with(ShapeRef ref, F&& f) const {
    return dispatch<0>(ref, std::forward<F>(f));
  }

  double bounding_radius(ShapeRef ref) const {
    return with(ref, [](const auto& s) { return s.bounding_radius(); });
  }
  Aabb bounding_box(ShapeRef ref, const Pose& pose) const {
    return with(ref, [&](const auto& s) { return s.bounding_box(pose); });
  }
  Aabb bounding_box(const World& world, Slot s) const { return bounding_box({world.shape[s]}, world.pose(s)); }

 private:
  template <std::size_t K, class F>
  decltype(auto) dispatch(ShapeRef ref, F&& f) const {
    if constexpr (K + 1 < sizeof...(S)) {
      if (ref.type() != K) return dispatch<K + 1>(ref, std::forward<F>(f));
    }
    return f(std::get<K>(columns_)[ref.index()]);
  }
  std::tuple<std::vector<S>...> columns_;
};

using ShapeStore = ShapeColumns<AllShapes>;

/// Names in the order of AllShapes: names[ref.type()].
template <class... S>
std::vector<Entry> shape_entries(ShapeList<S...>) {
  return {S::entry()...};
}

}  // namespace epafi
