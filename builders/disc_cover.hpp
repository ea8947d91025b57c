// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "builders/overhang.hpp"
#include "medial/ball.hpp"
#include "medial/cell_set.hpp"

namespace spheretree::builders {

/// Area of a triangle outside the union of some balls, in closed form, bracketed by its rounding.
/// `candidates` are the balls that may meet the triangle.
[[nodiscard]] Bounds areaOutside(const medial::SurfaceCell& triangle, std::span<const medial::Ball> balls,
                                 std::span<const std::uint32_t> candidates);

}  // namespace spheretree::builders
