// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string_view>

namespace spheretree::medial {

/// How a long operation runs: threads, cancellation, progress. Shared by reference, never changes a result.
class Context {
 public:
  /// Called with the stage's name and the fraction of it that is done, from whichever thread got there,
  /// one call at a time. Must not throw.
  using Progress = std::function<void(std::string_view stage, double fraction)>;

  /// `threads` = 0 takes every processor that the process may use.
  explicit Context(unsigned threads = 0, Progress progress = {});

  [[nodiscard]] unsigned threads() const noexcept { return threads_; }

  /// Asks the running operation to stop soon. Any thread, any number of times, safe in a signal handler.
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

  /// Throws CancelledError after cancel(). Long loops call it every millisecond or so.
  void checkCancelled() const;

  /// Reports progress of a stage, `fraction` in [0, 1].
  void report(std::string_view stage, double fraction) const;

 private:
  unsigned threads_;
  Progress progress_;
  mutable std::mutex progressMutex_;
  std::atomic<bool> cancelled_{false};
};

/// Thrown inside the toolkit when a Context was cancelled; turned into ErrorCode::Cancelled at the border.
struct CancelledError {};

}  // namespace spheretree::medial
