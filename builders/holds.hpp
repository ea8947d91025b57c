// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "medial/ball.hpp"

namespace spheretree::builders {

/// Squared radii are taken shorter by this fraction in proofs. A squared distance computed in double is wrong
/// by at most five roundings, 6e-16 of itself; the margin is well above that and nothing against the rounding
/// of a radius to float, 6e-8.
inline constexpr double kHoldsMargin = 1e-14;

/// Whether the point lies in the ball beyond any doubt of rounding. The one containment test of all proofs:
/// who makes balls that are to pass them should ask it too.
[[nodiscard]] inline bool holds(const medial::Ball& ball, const Eigen::Vector3d& point) {
  return (point - ball.center).squaredNorm() <= ball.radius * ball.radius * (1 - kHoldsMargin);
}

}  // namespace spheretree::builders
