// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/context.hpp"

#include <omp.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <utility>

#include "medial/parallel.hpp"

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace spheretree::medial {
namespace {

/// Tells the thread sanitizer what the OpenMP runtime, which is not instrumented, guarantees: what happens
/// before a parallel region is seen inside it, and what happens inside is seen after it.
[[maybe_unused]] char forkAndJoin;
void publish() {
#if defined(__SANITIZE_THREAD__)
  __tsan_release(&forkAndJoin);
#endif
}
void observe() {
#if defined(__SANITIZE_THREAD__)
  __tsan_acquire(&forkAndJoin);
#endif
}

}  // namespace

Context::Context(unsigned threads, Progress progress)
    : threads_(threads != 0 ? threads : static_cast<unsigned>(std::max(1, omp_get_num_procs()))),
      progress_(std::move(progress)) {}

void Context::checkCancelled() const {
  if (cancelled()) throw CancelledError{};
}

void Context::report(std::string_view stage, double fraction) const {
  if (!progress_) return;
  const std::lock_guard lock(progressMutex_);
  progress_(stage, std::clamp(fraction, 0.0, 1.0));
}

void parallelFor(std::size_t count, const Context& context, const std::function<void(std::size_t)>& body) {
  if (context.threads() == 1 || count < 2) {
    for (std::size_t i = 0; i < count; ++i) {
      context.checkCancelled();
      body(i);
    }
    return;
  }
  std::mutex mutex;
  std::exception_ptr failure;
  std::size_t failedIndex = count;
  const auto run = [&](std::size_t i) {
    try {
      context.checkCancelled();
      body(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (i < failedIndex) {
        failedIndex = i;
        failure = std::current_exception();
      }
    }
  };
  const auto threads = static_cast<int>(std::min<std::size_t>(context.threads(), count));
  publish();
#pragma omp parallel num_threads(threads)
  {
    observe();
#pragma omp for schedule(dynamic, 1) nowait
    for (std::size_t i = 0; i < count; ++i) {
      bool skip = false;
      {
        const std::lock_guard lock(mutex);
        skip = i > failedIndex;
      }
      if (!skip) run(i);
    }
    publish();
  }
  observe();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace spheretree::medial
