// SPDX-License-Identifier: MIT

#include "worker_pool.hpp"

namespace spheretree::detail {

WorkerPool::WorkerPool(std::uint32_t threads) {
  for (std::uint32_t worker = 1; worker < threads; ++worker)
    threads_.push_back(std::thread([this, worker] { serve(worker); }));
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerPool::run(Task task, void* context) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    task_ = task;
    context_ = context;
    busy_ = static_cast<std::uint32_t>(threads_.size());
    ++round_;
  }
  wake_.notify_all();
  task(context, 0);
  std::unique_lock<std::mutex> lock(mutex_);
  done_.wait(lock, [this] { return busy_ == 0; });
}

void WorkerPool::serve(std::uint32_t worker) {
  std::uint64_t served = 0;
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return stop_ || round_ != served; });
    if (stop_) return;
    served = round_;
    const Task task = task_;
    void* const context = context_;
    lock.unlock();
    task(context, worker);
    lock.lock();
    if (--busy_ == 0) done_.notify_one();
  }
}

}  // namespace spheretree::detail
