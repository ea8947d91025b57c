// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>
#include <span>

#include <spheretree/aabb.hpp>
#include <spheretree/broad_phase.hpp>
#include <spheretree/result.hpp>

namespace spheretree::detail {

/// What a broad phase answers when every box is in order.
inline constexpr std::size_t kNoFault = std::numeric_limits<std::size_t>::max();

/// Engines number records and bodies with 32 bits and keep two of them for marks.
inline constexpr std::size_t kMaxBodies = std::size_t{1} << 30U;

[[nodiscard]] constexpr bool isWellFormed(const Aabb& box) noexcept {
  constexpr float kLargest = std::numeric_limits<float>::max();
  return box.min.x <= box.max.x && box.min.y <= box.max.y && box.min.z <= box.max.z &&  // no NaN passes
         box.min.x >= -kLargest && box.min.y >= -kLargest && box.min.z >= -kLargest &&
         box.max.x <= kLargest && box.max.y <= kLargest && box.max.z <= kLargest;
}

/// Of a box that is known to be either well formed or absent.
[[nodiscard]] constexpr bool isAbsent(const Aabb& box) noexcept {
  return box.min.x > box.max.x;
}

/// The first box that is neither well formed nor absent, or kNoFault.
[[nodiscard]] inline std::size_t firstFault(std::span<const Aabb> boxes) noexcept {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!isWellFormed(boxes[i]) && boxes[i] != kAbsentBox) return i;
  }
  return kNoFault;
}

[[nodiscard]] Error faultAt(std::size_t index);
[[nodiscard]] Error tooManyBoxes();

}  // namespace spheretree::detail
