#include "engine/threads/event_count.h"

#if defined(__linux__)
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <limits>
#endif

namespace epafi {

#if defined(__linux__)
// Not std::atomic::wait: libstdc++ yields before it sleeps, which costs a time slice of a busy program.
void EventCount::sleep(std::uint32_t calls) {
  syscall(SYS_futex, &calls_, FUTEX_WAIT_PRIVATE, calls, nullptr, nullptr, 0);
}
void EventCount::wake_all() {
  ++calls_;
  syscall(SYS_futex, &calls_, FUTEX_WAKE_PRIVATE, std::numeric_limits<int>::max(), nullptr, nullptr, 0);
}
#else
void EventCount::sleep(std::uint32_t calls) { calls_.wait(calls); }
void EventCount::wake_all() {
  ++calls_;
  calls_.notify_all();
}
#endif

}  // namespace epafi
