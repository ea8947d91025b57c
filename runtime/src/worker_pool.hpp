// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace spheretree::detail {

/// Threads that wait for work. A run hands every thread, the caller among them, its number; no heap.
class WorkerPool {
 public:
  using Task = void (*)(void* context, std::uint32_t worker);

  /// `threads` in all, the caller included; at least 1.
  explicit WorkerPool(std::uint32_t threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Calls task(context, 0 ... threads - 1), the first on this thread; returns when all are done.
  void run(Task task, void* context);

 private:
  void serve(std::uint32_t worker);

  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable done_;
  Task task_ = nullptr;
  void* context_ = nullptr;
  std::uint64_t round_ = 0;  // a new one for each run
  std::uint32_t busy_ = 0;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace spheretree::detail
