/// @file keep_threads.h  Restores the number of threads at the end of a test, however it ends.
#pragma once
#include "engine/threads/parallel.h"

namespace epafi::support {

struct KeepThreads {
  int before = thread_count();
  ~KeepThreads() { set_thread_count(before); }
};

}  // namespace epafi::support
