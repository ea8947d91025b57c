// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace spheretree::cli {
namespace {

constexpr std::chrono::milliseconds kBetweenDrawings{100};  // as often as an eye cares
constexpr std::size_t kBarWidth = 40;                       // leaves room for the words in 80 columns
constexpr std::size_t kStageWidth = 12;

}  // namespace

ProgressBar::ProgressBar(Verbosity verbosity)
    : shown_(verbosity != Verbosity::Quiet && ::isatty(STDERR_FILENO) == 1) {}

medial::Context::Progress ProgressBar::callback() {
  if (!shown_) return {};
  return [this](std::string_view stage, double fraction) { draw(stage, fraction); };
}

void ProgressBar::wipe() {
  if (width_ == 0) return;
  const std::string line = "\r" + std::string(width_, ' ') + "\r";
  std::fwrite(line.data(), 1, line.size(), stderr);
  width_ = 0;
}

void ProgressBar::draw(std::string_view stage, double fraction, std::string_view note) noexcept {
  const Clock::time_point now = Clock::now();
  if (stage == stage_ && now - last_ < kBetweenDrawings) return;
  try {
    last_ = now;
    stage_ = stage;
    const double share = std::clamp(fraction, 0.0, 1.0);
    const auto filled = static_cast<std::size_t>(std::lround(share * static_cast<double>(kBarWidth)));
    const auto percent = static_cast<int>(std::lround(100 * share));
    std::string line = "\r" + stage_;
    line += std::string(kStageWidth - std::min(kStageWidth, stage_.size()), ' ');
    line += " [" + std::string(filled, '#') + std::string(kBarWidth - filled, '.') + "] " +
            std::to_string(percent) + " % ";
    line += note;
    const std::size_t width = line.size() - 1;
    if (width < width_) line += std::string(width_ - width, ' ');  // over the end of a longer line
    width_ = std::max(width_, width);
    std::fwrite(line.data(), 1, line.size(), stderr);
  } catch (...) {  // no memory for a line of text: a job must not die of its progress bar
  }
}

}  // namespace spheretree::cli
