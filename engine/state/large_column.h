/// @file large_column.h  Large columns in pages of 2 MB if the system has them. The loop over spheres reads partners
/// all over its columns; with pages of 4 kB every other read misses the TLB (26 MB of a bed of 100 000 are 6500 pages,
/// twice the TLB's size).
#pragma once
#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace epafi {

inline constexpr std::size_t large_page = std::size_t{2} << 20;
/// Whole large pages, then small ones; std::bad_alloc if there is no memory.
void* large_pages(std::size_t bytes);
void free_large_pages(void* p);
template <class T>
struct LargePages {
  using value_type = T;
  static constexpr std::size_t least = large_page;  ///< smaller columns are on the heap

  LargePages() = default;
  template <class U>
  LargePages(const LargePages<U>&) {}

  T* allocate(std::size_t n) {
    const std::size_t bytes = n * sizeof(T);
    return static_cast<T*>(bytes < least ? ::operator new (bytes, std::align_val_t{64}) : large_pages(bytes));
  }
  void deallocate(T* p, std::size_t n) {
    if (n * sizeof(T) < least)
      ::operator delete (p, std::align_val_t{64});
    else
      free_large_pages(p);
  }
  template <class U>
  bool operator==(const LargePages<U>&) const {
    return true;
  }
};

template <class T>
using LargeColumn = std::vector<T, LargePages<T>>;

/// A column whose elements are written before they are read: `resize` does not initialise them. A page is placed near
/// the processor that writes it first, and unwritten pages take no memory.
template <class T>
struct UnwrittenPages : LargePages<T> {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  UnwrittenPages() = default;
  template <class U>
  UnwrittenPages(const UnwrittenPages<U>&) {}
  template <class U>
  void construct(U*) noexcept {}
  template <class U, class... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
};

template <class T>
using UnwrittenColumn = std::vector<T, UnwrittenPages<T>>;

/// The same in small pages, for data read in order. (With rows of a solver in large pages the narrow phase of 5000
/// stones takes 1.60 instead of 1.44 s on a virtual Zen 5, for an unknown reason.)
template <class T>
struct UnwrittenSmallPages : UnwrittenPages<T> {
  UnwrittenSmallPages() = default;
  template <class U>
  UnwrittenSmallPages(const UnwrittenSmallPages<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{64})); }
  void deallocate(T* p, std::size_t) { ::operator delete (p, std::align_val_t{64}); }
};

template <class T>
using UnwrittenStream = std::vector<T, UnwrittenSmallPages<T>>;

/// `= {}` would keep the room.
template <class Column>
void release(Column& column) {
  Column().swap(column);
}

/// Sets the size, with all elements uninitialised and the old ones discarded. A column that must grow is freed first,
/// then reserves a quarter more than needed, which takes no memory until written; small columns reserve another share.
template <class T, class Pages>
void renew(std::vector<T, Pages>& column, std::size_t size, std::size_t share = 4) {
  static_assert(std::is_base_of_v<UnwrittenPages<T>, Pages>);
  if (size > column.capacity()) {
    release(column);
    column.reserve(size + size / share);
  }
  column.clear();
  column.resize(size);
}

}  // namespace epafi
