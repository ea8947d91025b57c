// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace spheretree::medial {

/// Answers whether any of many points is near a place. Keeps a reference to the points. Fast when points next
/// to each other in the list are near in space, as the corners of a region's cells are. Const members may be
/// called from any number of threads at once.
class NearPoints {
 public:
  explicit NearPoints(std::span<const Eigen::Vector3d> points);

  /// `last`: index of the point to try first, replaced by that of the one found.
  [[nodiscard]] bool anyWithin(const Eigen::Vector3d& place, double distance, std::size_t& last) const;

 private:
  struct Level {
    std::size_t first;
    std::size_t count;
  };
  std::span<const Eigen::Vector3d> points_;
  std::vector<Eigen::AlignedBox3d> boxes_;  // level by level, leaves first
  std::vector<Level> levels_;
};

}  // namespace spheretree::medial
