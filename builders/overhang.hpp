// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "medial/ball.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// Two numbers that bracket a third, both in mesh units unless said otherwise.
struct Bounds {
  double lower = 0;
  double upper = 0;
};

/// The farthest that any point of `ball` outside the solid is from the surface (docs/error-metrics.md).
struct Overhang {
  Bounds value;                                       ///< 0 when the ball lies inside the solid
  Eigen::Vector3d witness = Eigen::Vector3d::Zero();  ///< a point of the ball that is value.lower outside
};

/// The upper bound that one query gives: radius - depth(center), which for a centre outside is radius +
/// distance; 0 for a ball inside the solid.
[[nodiscard]] double quickOverhang(const medial::Surface& surface, const medial::Ball& ball);

/// Branch and bound over the whole ball until upper - lower <= max(relativeGap * upper, absoluteGap), or for
/// a fixed number of steps (20000; about a hundred is typical): then the bracket is wider but as
/// valid. Certified: convexity and the Lipschitz constant of the distance, no sampling. Deterministic.
[[nodiscard]] Overhang boundOverhang(const medial::Surface& surface, const medial::Ball& ball,
                                     double relativeGap, double absoluteGap);

}  // namespace spheretree::builders
