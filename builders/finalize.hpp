// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <spheretree/result.hpp>
#include <spheretree/sphere.hpp>
#include <spheretree/sphere_tree.hpp>

#include "builders/ball_tree.hpp"
#include "medial/ball.hpp"

namespace spheretree::builders {

/// The smallest float ball at the rounded centre that holds `ball`: round the centre, grow the radius by the
/// rounding distance, round it up. The one place where double becomes float.
[[nodiscard]] Sphere toSphere(const medial::Ball& ball);

/// The tree in float, each radius first grown by a millionth: balls that meet exactly on the surface then
/// overlap a little, which is what lets a proof by subdivision end there.
[[nodiscard]] Result<SphereTree> finalize(const BallTree& tree);

}  // namespace spheretree::builders
