// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "medial/ball.hpp"

namespace spheretree::builders {

/// Volume of the union of balls, overlaps counted once: each ball is cut to its cell of the power diagram and
/// the pieces are summed in closed form. Exact up to rounding (about 1e-12 of the result).
[[nodiscard]] double unionVolume(std::span<const medial::Ball> balls);

}  // namespace spheretree::builders
