// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "medial/ball.hpp"

namespace spheretree::medial {

/// The smallest ball around the points, after Gärtner, "Fast and robust smallest enclosing balls", ESA 1999.
/// The radius is the distance to the farthest point as computed in double, so it is never short by more than
/// rounding. Expected O(n). No points give a ball of radius 0 at the origin.
[[nodiscard]] Ball minBall(std::span<const Eigen::Vector3d> points);

}  // namespace spheretree::medial
