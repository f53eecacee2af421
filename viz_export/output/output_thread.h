/// @file output_thread.h  Files written beside the run, by a thread of its own.
#pragma once
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace epafi {

/// One job at a time: add() waits until the last one is done, so files are in the order of the run and only one copy of
/// their data is in memory. HDF5 is not thread-safe: between add() and wait() nobody else may call it.
class OutputThread {
 public:
  OutputThread() = default;
  /// Waits for the last job; what it threw is lost.
  ~OutputThread();
  OutputThread(const OutputThread&) = delete;
  OutputThread& operator=(const OutputThread&) = delete;

  /// Throws what the job before threw; then this one is not begun. The job must own all that it reads. Its loops are
  /// its own thread's alone.
  void add(std::function<void()> job);
  /// Until the last job is done. Throws what it threw, once.
  void wait();

 private:
  bool start();
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> job_;   ///< empty: there is none
  std::exception_ptr trouble_;  ///< of the last job
  bool ends_ = false;
  std::thread thread_;  ///< begins with the first job
};

}  // namespace epafi
