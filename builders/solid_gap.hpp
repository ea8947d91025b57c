// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Geometry>

#include "builders/overhang.hpp"
#include "medial/ball.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// Volume of the solid inside a cube that lies in none of the balls, in closed form and bracketed by its
/// rounding; nothing if the solid's shape in the cube is neither convex nor the cube without something
/// convex. `triangles` are those that may meet the cube; none mean that the cube is all solid.
[[nodiscard]] std::optional<Bounds> solidOutside(const medial::Surface& surface,
                                                 const Eigen::AlignedBox3d& cube,
                                                 std::span<const std::uint32_t> triangles,
                                                 std::span<const medial::Ball> balls);

}  // namespace spheretree::builders
