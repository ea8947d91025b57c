// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress_bar.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace spheretree::cli {
namespace {

constexpr std::chrono::milliseconds kBetweenDrawings{100};  // as often as an eye cares
constexpr std::size_t kWidestBar = 40;
constexpr std::size_t kNarrowestBar = 4;  // below that the percentage says more
constexpr std::size_t kStageWidth = 12;
constexpr std::size_t kUsualColumns = 80;  // of a terminal that does not tell

std::size_t columnsOfTerminal() {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsualColumns;
  return size.ws_col;
}

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}

/// The bar takes what stage, percentage and `noteWidth` leave of the columns, or goes.
std::string lineOf(const std::string& stage, double share, std::string_view note, std::size_t noteWidth,
                   std::size_t columns) {
  const std::string percent = std::to_string(std::lround(100 * share)) + " %";
  constexpr std::size_t kPercentWidth = 5;
  constexpr std::size_t kBlanksAndBrackets = 5;
  const std::size_t taken = kStageWidth + kPercentWidth + noteWidth + kBlanksAndBrackets;
  const std::size_t width = columns > taken ? std::min(columns - taken, kWidestBar) : 0;
  std::string line = padded(stage, kStageWidth) + " ";
  if (width >= kNarrowestBar) {
    const auto filled = static_cast<std::size_t>(std::lround(share * static_cast<double>(width)));
    line += "[" + std::string(filled, '#') + std::string(width - filled, '.') + "] ";
  }
  line += std::string(kPercentWidth - std::min(kPercentWidth, percent.size()), ' ') + percent + " ";
  line += note;
  return line.substr(0, columns);
}

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
    noteWidth_ = std::max(noteWidth_, note.size());
    // One column stays free: a line that fills the last one is two on some terminals, and "\r" returns to the
    // second.
    const std::size_t columns = columnsOfTerminal() - 1;
    const std::string text = lineOf(stage_, std::clamp(fraction, 0.0, 1.0), note, noteWidth_, columns);
    // Over the end of a longer line.
    const std::string line = "\r" + padded(text, std::min(width_, columns));
    width_ = line.size() - 1;
    std::fwrite(line.data(), 1, line.size(), stderr);
  } catch (...) {  // no memory for a line of text: a job must not die of its progress bar
  }
}

}  // namespace spheretree::cli
