/// @file state_column.h  Position, velocity, spin and inertia of the bodies: a column each, or all of a body in one
/// place.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <vector>

#include "engine/lanes/lanes.h"
#include "engine/state/large_column.h"

namespace epafi {

/// Position and velocities of a body with the data that a loop over contacts reads with them: 128 bytes, two cache
/// lines. Radii, `predicted` and, for unequal moments, its fourth number belong to the contact model.
struct alignas(64) BodyState {
  Lanes position;   ///< x y z [m], radius [m]
  Lanes velocity;   ///< x y z [m/s], 1/mass [1/kg]
  Lanes spin;       ///< x y z [rad/s], radius [m]
  Lanes predicted;  ///< velocity at the time of the detection [m/s], 1/moment of inertia [1/(kg m^2)]
};

/// A column by slot: either a contiguous array, or a strided view of one member of an array of records. Copies are
/// arrays.
template <class T>
class StateColumn {
 public:
  using value_type = T;
  template <class Element>
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = Element*;
    using reference = Element&;
    Iterator() = default;
    Iterator(std::byte* at, std::size_t stride) : at_(at), stride_(stride) {}
    Element& operator*() const { return *reinterpret_cast<Element*>(at_); }
    Iterator& operator++() {
      at_ += stride_;
      return *this;
    }
    Iterator operator++(int) {
      Iterator before = *this;
      ++*this;
      return before;
    }
    bool operator==(const Iterator& o) const { return at_ == o.at_; }

   private:
    std::byte* at_ = nullptr;
    std::size_t stride_ = sizeof(T);
  };

  StateColumn() = default;
  StateColumn(const StateColumn& o) : own_(o.begin(), o.end()) { stand_alone(); }
  StateColumn(StateColumn&&) noexcept = default;
  ~StateColumn() = default;
  /// If this is a view of records, the sizes must agree.
  StateColumn& operator=(const StateColumn& o) {
    if (this == &o) return *this;
    resize(o.size());
    for (std::size_t s = 0; s < size_; ++s) (*this)[s] = o[s];
    return *this;
  }
  StateColumn& operator=(StateColumn&&) noexcept = default;

  T& operator[](std::size_t s) { return *reinterpret_cast<T*>(first_ + s * stride_); }
  const T& operator[](std::size_t s) const { return *reinterpret_cast<const T*>(first_ + s * stride_); }
  bool operator==(const StateColumn& o) const { return size_ == o.size_ && std::equal(begin(), end(), o.begin()); }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t stride() const { return stride_; }  ///< from one element to the next [B]
  Iterator<T> begin() { return {first_, stride_}; }
  Iterator<T> end() { return {first_ + size_ * stride_, stride_}; }
  Iterator<const T> begin() const { return {first_, stride_}; }
  Iterator<const T> end() const { return {first_ + size_ * stride_, stride_}; }

  bool in_records() const { return in_records_; }

  /// Does nothing for a view of records, like resize: their number is fixed elsewhere.
  void reserve(std::size_t n) {
    if (!in_records_) {
      own_.reserve(n);
      stand_alone();
    }
  }
  void resize(std::size_t n) {
    if (!in_records_) {
      own_.resize(n);
      stand_alone();
    }
  }
  /// Becomes a view of `size` records; first: its member in the first one; stride: size of a record [B].
  void join(void* first, std::size_t stride, std::size_t size) {
    in_records_ = true;
    first_ = static_cast<std::byte*>(first);
    stride_ = stride;
    size_ = size;
  }
  /// Calls f with a vector of all elements, which it may change; also their number, except in records.
  template <class F>
  void as_vector(const F& f) {
    if (!in_records_) {
      f(own_);
      return stand_alone();
    }
    LargeColumn<T> all(begin(), end());
    f(all);
    const std::size_t n = std::min(size_, all.size());
    for (std::size_t s = 0; s < n; ++s)  // mostly only saved: unwritten records stay in the cache
      if (std::memcmp(&(*this)[s], &all[s], sizeof(T)) != 0) (*this)[s] = all[s];
  }

 private:
  static std::byte* bytes(T* p) { return reinterpret_cast<std::byte*>(p); }
  void stand_alone() {
    first_ = bytes(own_.data());
    stride_ = sizeof(T);
    size_ = own_.size();
  }

  std::vector<T> own_;
  std::byte* first_ = nullptr;
  std::size_t stride_ = sizeof(T), size_ = 0;
  bool in_records_ = false;
};

}  // namespace epafi
