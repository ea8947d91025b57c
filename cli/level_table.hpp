// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

#include "builders/metrics.hpp"

namespace spheretree::cli {

/// The table that `build` and `eval` print, a line per level. Upper bounds throughout; lengths as per cent
/// of `diagonal` and in mesh units. `setsWon` is the text of one more column, or empty.
[[nodiscard]] std::string levelTable(std::span<const builders::LevelMetrics* const> levels, double diagonal,
                                     std::span<const std::string> setsWon = {});

}  // namespace spheretree::cli
