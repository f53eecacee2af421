/// @file large_column.h  Columns of many megabytes in pages of 2 MB where the system has them: the loop over spheres
/// reads partners all over its columns, and with pages of 4 kB every other such read waits for the page table first
/// (a bed of 100 000: 26 MB are 6500 pages, twice what the processor remembers).
#pragma once
#include <cstdint>
#include <cstdlib>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace epafi {

template <class T>
struct LargePages {
  using value_type = T;
  static constexpr std::size_t page = std::size_t{2} << 20;
  static constexpr std::size_t least = 4 * page;  ///< smaller columns stay where the heap puts them

  LargePages() = default;
  template <class U>
  LargePages(const LargePages<U>&) {}

  T* allocate(std::size_t n) {
    const std::size_t bytes = n * sizeof(T), whole = (bytes + page - 1) / page * page;
    if (bytes < least) return static_cast<T*>(::operator new(bytes, std::align_val_t{64}));
    void* p = std::aligned_alloc(page, whole);
    if (p == nullptr) throw std::bad_alloc();
#if defined(__linux__)
    madvise(p, whole, MADV_HUGEPAGE);  // a wish: refused, the column works as well, only slower
#endif
    return static_cast<T*>(p);
  }
  void deallocate(T* p, std::size_t n) {
    if (n * sizeof(T) < least)
      ::operator delete(p, std::align_val_t{64});
    else
      std::free(p);
  }
  template <class U>
  bool operator==(const LargePages<U>&) const {
    return true;
  }
};

template <class T>
using LargeColumn = std::vector<T, LargePages<T>>;

/// A column whose elements are written before they are read: `resize` leaves them as they are, so that the thread which
/// writes a page first has it near, and pages that nobody has written yet take no memory.
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

/// The system may take the whole pages within [begin, end): what is there is not read again.
inline void give_back_pages([[maybe_unused]] void* begin, [[maybe_unused]] void* end) {
#if defined(__linux__)
  constexpr std::uintptr_t page = 4096;
  const std::uintptr_t from = (page - reinterpret_cast<std::uintptr_t>(begin) % page) % page;  // to the first whole page
  const auto bytes = static_cast<std::uintptr_t>(static_cast<char*>(end) - static_cast<char*>(begin));
  if (bytes >= from + page) madvise(static_cast<char*>(begin) + from, (bytes - from) / page * page, MADV_DONTNEED);
#endif
}

}  // namespace epafi
