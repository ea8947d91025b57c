// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include <Eigen/Core>

#include "medial/ball.hpp"

namespace spheretree::builders {

/// Volume of the union of balls, overlaps counted once: each ball is cut to its cell of the power diagram and
/// the pieces are summed in closed form. Exact up to rounding (about 1e-12 of the result).
[[nodiscard]] double unionVolume(std::span<const medial::Ball> balls);

/// The points x with normal . x <= offset. The normal has unit length.
struct HalfSpace {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  double offset = 0;
};

/// Volume of the part of the union that lies in all the half-spaces. The error is about 1e-15 of the cubed
/// radius per ball, however small that part is.
[[nodiscard]] double unionVolumeIn(std::span<const medial::Ball> balls,
                                   std::span<const HalfSpace> halfSpaces);

}  // namespace spheretree::builders
