// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// For each point the lowest index of a point at exactly the same position (-0 equals 0). O(n log n).
[[nodiscard]] std::vector<std::uint32_t> firstAtSamePosition(std::span<const Eigen::Vector3d> points);

/// Makes -0 coordinates 0, gives triangles the first vertex of each position, drops vertices that no triangle
/// uses and keeps the order of the others.
[[nodiscard]] medial::TriangleMesh weldVertices(medial::TriangleMesh mesh);

/// Cuts a polygon into corners - 2 triangles of the same orientation, with no new vertex. Quadrilaterals
/// along the better diagonal, larger polygons by a constrained Delaunay triangulation in the coordinate plane
/// they face most; a polygon that crosses itself there becomes a fan. `corners` has at least three, all
/// different.
[[nodiscard]] std::vector<medial::TriangleMesh::Triangle> triangulatePolygon(
    std::span<const Eigen::Vector3d> points, std::span<const std::uint32_t> corners);

/// Removes triangles with two equal corners or exactly zero area, returns how many there were. When three
/// different corners lie on a line, the triangles on the other side of the longest edge are split at the
/// middle corner, so that a closed mesh stays closed and the surface stays where it is. Splitting ends where
/// the triangles would become more than four times as many; the slivers left then are just dropped.
std::size_t removeDegenerate(medial::TriangleMesh& mesh);

/// Removes triangles with the corners and the orientation of an earlier one, returns how many. O(n log n).
std::size_t removeDuplicates(medial::TriangleMesh& mesh);

}  // namespace spheretree::io
