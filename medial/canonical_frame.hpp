// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "medial/triangle_mesh.hpp"

namespace spheretree::medial {

/// A similarity that puts a mesh where its own shape says: centroid of the surface at the origin, every
/// vertex within distance 1, axes along the principal axes where these are distinct, otherwise along the
/// directions that most of the area faces. Moving, turning or scaling the mesh does not change the result
/// but for rounding, so whoever works in this frame is invariant too.
struct CanonicalFrame {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< rows: right-handed, orthonormal, mesh frame
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< mesh units
  double scale = 1;                                    ///< mesh units per canonical unit, positive

  [[nodiscard]] Eigen::Vector3d forward(const Eigen::Vector3d& p) const {
    return axes * (p - origin) / scale;
  }
  [[nodiscard]] Eigen::Vector3d backward(const Eigen::Vector3d& p) const {
    return axes.transpose() * p * scale + origin;
  }
};

/// The frame of a mesh with at least one triangle of positive area, to the bit the same for any order of its
/// vertices, no two at the same place, and triangles. O(n log n).
[[nodiscard]] CanonicalFrame canonicalFrame(const TriangleMesh& mesh);

/// What becomes of the vertices: as computed, or moved to the nearest multiple of 2^-32, so that the same
/// shape in two places or attitudes has the same bits almost always.
enum class Places : std::uint8_t { Exact, Snapped };

/// The mesh moved into the frame, its vertices sorted by place and its triangles by their vertices: whatever
/// the order they come in, what is decided by index there is decided by shape. O(n log n).
[[nodiscard]] TriangleMesh toFrame(const TriangleMesh& mesh, const CanonicalFrame& frame, Places places);

}  // namespace spheretree::medial
