// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "builders/cover_table.hpp"
#include "medial/context.hpp"
#include "medial/random.hpp"

namespace spheretree::builders {

/// Candidates whose balls of this stand-off, not above the table's, hold all rows: always the one that holds
/// the most rows that nothing held before. Nothing when it would take more than `most`.
[[nodiscard]] std::optional<std::vector<std::uint32_t>> greedyCover(const CoverTable& table, double standOff,
                                                                    std::uint32_t most);

struct SwapSettings {
  std::uint32_t most = 1;   ///< candidates that may be chosen
  std::uint32_t steps = 0;  ///< swaps tried
};

/// Swaps candidates, from `start` on, until the balls of at most `most` of them hold all rows at the table's
/// stand-off. Nothing when that did not work out in so many steps.
[[nodiscard]] std::optional<std::vector<std::uint32_t>> coverBySwaps(const CoverTable& table,
                                                                     const std::vector<std::uint32_t>& start,
                                                                     const SwapSettings& settings,
                                                                     medial::Random& random,
                                                                     const medial::Context& context);

}  // namespace spheretree::builders
