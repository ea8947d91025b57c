// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include <spheretree/sphere_tree.hpp>

#include "mesh.hpp"

namespace crowded_room {

/// How far each ball sticks out of a closed mesh in the same units: the largest distance from the mesh over
/// points of the ball outside of it, sampled, so a little too small. For colours; `spheretree eval` measures.
/// Half a second for 500 balls and 1500 triangles.
[[nodiscard]] std::vector<float> overhangsOf(std::span<const spheretree::Node> balls, const Mesh& mesh);

}  // namespace crowded_room
