// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace spheretree::medial {

/// An indexed triangle soup in mesh units. Counter-clockwise corners seen from outside, where there is one.
struct TriangleMesh {
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> triangles;

  [[nodiscard]] const Eigen::Vector3d& corner(std::size_t triangle, std::size_t k) const {
    return vertices[triangles[triangle][k]];
  }
};

/// The box around the vertices that some triangle uses; empty for a mesh without triangles.
[[nodiscard]] Eigen::AlignedBox3d boundsOf(const TriangleMesh& mesh);

/// Length of the diagonal of boundsOf(): what relative errors are fractions of.
[[nodiscard]] double diagonalOf(const TriangleMesh& mesh);

[[nodiscard]] double areaOf(const TriangleMesh& mesh);

/// A clause that says why areas, volumes and moments of the mesh would leave the range of doubles, because it
/// is far too large or too small; empty when they do not. Coordinates are finite.
[[nodiscard]] std::string whyNotMeasurable(const TriangleMesh& mesh);

/// Volume by the divergence theorem: positive for a closed mesh oriented outwards. A part of space that the
/// surface winds around twice counts twice.
[[nodiscard]] double signedVolumeOf(const TriangleMesh& mesh);

/// True when every edge is used as often in one direction as in the other, so that winding numbers exist.
[[nodiscard]] bool boundsVolume(const TriangleMesh& mesh);

}  // namespace spheretree::medial
