#include "engine/state/large_column.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#if defined(__linux__)
#include <sys/mman.h>
#endif
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace epafi {

void* large_pages(std::size_t bytes) {
  void* p = std::aligned_alloc(large_page, (bytes + large_page - 1) / large_page * large_page);
  if (p == nullptr) throw std::bad_alloc();
#if defined(__linux__)
  madvise(p, bytes / large_page * large_page, MADV_HUGEPAGE);  // a wish: refused, the column works as well, only slower
#endif
  return p;
}

void free_large_pages(void* p) { std::free(p); }

void give_back_pages([[maybe_unused]] void* begin, [[maybe_unused]] void* end) {
#if defined(__linux__)
  constexpr std::uintptr_t page = 4096;
  const std::uintptr_t from =
      (page - reinterpret_cast<std::uintptr_t>(begin) % page) % page;  // to the first whole page
  const auto bytes = static_cast<std::uintptr_t>(static_cast<char*>(end) - static_cast<char*>(begin));
  if (bytes >= from + page) madvise(static_cast<char*>(begin) + from, (bytes - from) / page * page, MADV_DONTNEED);
#endif
}

void give_back_piece(void* column, void* begin, void* end) {
  const auto whole = [](void* p) { return reinterpret_cast<std::uintptr_t>(p) / large_page * large_page; };
  const auto from = std::max(whole(begin), reinterpret_cast<std::uintptr_t>(column)), to = whole(end);
  if (from < to) give_back_pages(reinterpret_cast<void*>(from), reinterpret_cast<void*>(to));
}

void give_back_heap() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

}  // namespace epafi
