#include "engine/state/large_column.h"

#include <cstdlib>

#if defined(__linux__)
#include <sys/mman.h>
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

}  // namespace epafi
