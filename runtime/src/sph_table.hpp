// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

namespace spheretree {

/// Rows of a complete `.sph` table: 1 + branch + ... + branch^(levels - 1). Nothing when 64 bits cannot count
/// them. Both arguments must be at least 1.
[[nodiscard]] constexpr std::optional<std::uint64_t> sphRowCount(std::uint64_t levels,
                                                                 std::uint64_t branch) noexcept {
  if (branch == 1) return levels;
  std::uint64_t rows = 1;
  for (std::uint64_t level = 1; level < levels; ++level) {  // branch >= 2: at most 64 rounds
    if (rows > (std::numeric_limits<std::uint64_t>::max() - 1) / branch) return std::nullopt;
    rows = rows * branch + 1;
  }
  return rows;
}

}  // namespace spheretree
