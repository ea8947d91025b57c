// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace spheretree::builders {

/// One place that an item may go to.
struct Choice {
  std::uint32_t place = 0;
  double cost = 0;  ///< at least 0
};

/// Gives every item one of its places, at most `capacity` items to a place, at the least sum of costs; of
/// each item the number of its place, or nothing when the places do not suffice. Costs are compared to 1e-12
/// of the largest.
[[nodiscard]] std::optional<std::vector<std::uint32_t>> assignWithinCapacity(
    std::span<const std::vector<Choice>> choices, std::size_t places, std::size_t capacity);

}  // namespace spheretree::builders
