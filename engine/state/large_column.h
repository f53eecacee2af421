/// @file large_column.h  Columns of many megabytes in pages of 2 MB where the system has them: the loop over spheres
/// reads partners all over its columns, and with pages of 4 kB every other such read waits for the page table first
/// (a bed of 100 000: 26 MB are 6500 pages, twice what the processor remembers).
#pragma once
#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace epafi {

inline constexpr std::size_t large_page = std::size_t{2} << 20;
/// As many whole large pages as fit in, small ones behind them; std::bad_alloc where there are none.
void* large_pages(std::size_t bytes);
void free_large_pages(void* p);
template <class T>
struct LargePages {
  using value_type = T;
  static constexpr std::size_t least = large_page;  ///< smaller columns stay where the heap puts them

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

/// The same in small pages, for what is read from front to back only. (Rows of a solver in large ones: the narrow phase
/// of 5000 stones, which does not touch them, took 1.60 s for 1.44 on a virtual Zen 5; why was not found.)
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

/// `size` elements, none of them written. What was there is gone, and gone first where the column must grow: by a
/// quarter more than asked for, which takes no memory until it is written, or by another share of small columns, whose
/// room was written by others.
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
