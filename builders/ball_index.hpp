// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "medial/ball.hpp"

namespace spheretree::builders {

/// A bounding-box hierarchy over balls. Refers to the balls, which must stay; const members are thread-safe.
class BallIndex {
 public:
  explicit BallIndex(std::span<const medial::Ball> balls);

  /// The balls that meet the box, ascending.
  [[nodiscard]] std::vector<std::uint32_t> meeting(const Eigen::AlignedBox3d& box) const;

  struct Nearest {
    std::uint32_t ball = 0;
    double distance = std::numeric_limits<double>::infinity();  ///< to the ball's surface; negative inside
  };

  /// For a point outside all balls the nearest one, the lowest-numbered among equals; for a point in some
  /// ball, one of those that hold it. No balls give an infinite distance.
  [[nodiscard]] Nearest nearest(const Eigen::Vector3d& point) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0;  // leaf: range of order_; inner: the two children, side by side
    std::uint32_t count = 0;  // 0 for an inner node
  };

  void build(std::uint32_t node, std::uint32_t first, std::uint32_t last);

  std::span<const medial::Ball> balls_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// Whether ball and box have a point in common.
[[nodiscard]] inline bool meets(const medial::Ball& ball, const Eigen::AlignedBox3d& box) {
  return box.squaredExteriorDistance(ball.center) <= ball.radius * ball.radius;
}

}  // namespace spheretree::builders
