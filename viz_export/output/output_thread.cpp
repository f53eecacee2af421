#include "viz_export/output/output_thread.h"

#include <system_error>
#include <utility>

#include "engine/threads/all_places.h"
#include "engine/threads/parallel.h"

namespace epafi {

OutputThread::~OutputThread() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

/// False where the system cannot create a thread (limit of processes or memory).
bool OutputThread::start() {
  if (thread_.joinable()) return true;
  const AllPlaces anywhere;
  try {
    thread_ = std::thread([this] { work(); });
  } catch (const std::system_error&) {
    return false;
  }
  return true;
}

void OutputThread::add(std::function<void()> job) {
  wait();
  if (!start()) return job();
  {
    const std::lock_guard lock(mutex_);
    job_ = std::move(job);
  }
  changed_.notify_all();
}

void OutputThread::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !job_; });
  if (const std::exception_ptr trouble = std::exchange(trouble_, nullptr)) std::rethrow_exception(trouble);
}

void OutputThread::work() {
  set_thread_count(1);
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return job_ || ends_; });
    if (!job_) return;
    lock.unlock();
    std::exception_ptr trouble;
    try {
      job_();
    } catch (...) {
      trouble = std::current_exception();
    }
    lock.lock();
    job_ = nullptr;
    trouble_ = trouble;
    changed_.notify_all();
  }
}

}  // namespace epafi
