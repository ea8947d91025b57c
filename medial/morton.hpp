// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace spheretree::medial {

/// Position of a point along the Z-order curve through `box`, 21 bits per axis. Near codes are near points.
[[nodiscard]] inline std::uint64_t mortonCode(const Eigen::Vector3d& point, const Eigen::AlignedBox3d& box) {
  constexpr std::uint32_t kBits = 21;
  constexpr double kCells = 1U << kBits;
  const double side = std::max(box.sizes().maxCoeff(), 1e-300);
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = (point[axis] - box.min()[axis]) / side * kCells;
    const auto bits = static_cast<std::uint64_t>(std::clamp(cell, 0.0, kCells - 1));
    for (std::uint32_t bit = 0; bit < kBits; ++bit) {
      code |= ((bits >> bit) & 1U) << (3 * bit + static_cast<std::uint32_t>(axis));
    }
  }
  return code;
}

}  // namespace spheretree::medial
