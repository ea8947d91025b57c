// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "builders/cover_table.hpp"
#include "builders/settings.hpp"

namespace spheretree::builders {

/// Decides whether the balls of these candidates will do.
using AcceptCover = std::function<bool(std::span<const std::uint32_t> chosen)>;

struct MeanGoal {
  double limit = 0;  ///< no row may need a greater stand-off
  Objective objective =
      Objective::Worst;  ///< Volume lowers the sum of the volumes, the others the mean overhang
};

/// Exchanges one candidate at a time for another one where that lowers the mean of what the balls still need,
/// each for the rows that ask least of it, and `accept` agrees. `chosen` must hold all rows at the limit.
[[nodiscard]] std::vector<std::uint32_t> swapForLowerMean(CoverTable& table,
                                                          std::vector<std::uint32_t> chosen,
                                                          const MeanGoal& goal, const AcceptCover& accept);

}  // namespace spheretree::builders
