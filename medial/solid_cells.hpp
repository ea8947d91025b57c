// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "medial/cell_set.hpp"
#include "medial/surface.hpp"

namespace spheretree::medial {

/// Points whose convex hull holds the solid inside `cube`: the cube's corners that are inside the solid and
/// the vertices of the surface triangles clipped to the cube. (An extreme point of solid-and-cube is either
/// a corner of the cube or on the surface.) Empty when the solid misses the cube.
///
/// `nearby` are triangles that may touch the cube, a superset is fine; surface.trianglesNear(cube) will do.
[[nodiscard]] std::vector<Eigen::Vector3d> solidPoints(const Surface& surface,
                                                       const Eigen::AlignedBox3d& cube,
                                                       std::span<const std::uint32_t> nearby);

/// Those of the solidPoints() that come from triangles, without a query: empty when no surface meets the
/// cube, which is then all solid or all empty.
[[nodiscard]] std::vector<Eigen::Vector3d> surfacePoints(const Surface& surface,
                                                         const Eigen::AlignedBox3d& cube,
                                                         std::span<const std::uint32_t> nearby);

/// The eight corners of a cube; bit k of the number says upper side on axis k.
[[nodiscard]] std::array<Eigen::Vector3d, 8> cornersOf(const Eigen::AlignedBox3d& cube);

/// The eight octants of a cube, numbered as its corners. Builders and proofs split with this one function.
[[nodiscard]] std::array<Eigen::AlignedBox3d, 8> octants(const Eigen::AlignedBox3d& cube);

/// The cube that solid cover starts from: centred on the surface's bounds, a little larger.
[[nodiscard]] Eigen::AlignedBox3d solidRootCube(const Surface& surface);

}  // namespace spheretree::medial
