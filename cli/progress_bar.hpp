// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

#include "cli/console.hpp"
#include "medial/context.hpp"

namespace spheretree::cli {

/// One line on standard error that says how far a long job is: drawn only when that is a terminal and the
/// user did not ask for quiet, wiped when the bar goes. Must outlive every Context that reports to it.
class ProgressBar {
 public:
  explicit ProgressBar(Verbosity verbosity);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { wipe(); }

  /// What to give to a Context; empty when nothing is to be drawn.
  [[nodiscard]] medial::Context::Progress callback();

  [[nodiscard]] bool shown() const noexcept { return shown_; }

  /// Draws the line, not more often than an eye cares and not wider than the terminal. `note` stands behind
  /// the bar.
  void draw(std::string_view stage, double fraction, std::string_view note = {}) noexcept;

  /// Makes room for other text.
  void wipe();

 private:
  using Clock = std::chrono::steady_clock;

  bool shown_;
  std::size_t width_ = 0;      // characters on the line now
  std::size_t noteWidth_ = 0;  // of the longest note: the bar does not jump with each of them
  std::string stage_;
  Clock::time_point last_;
};

}  // namespace spheretree::cli
