// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Geometry>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// Facts about a triangle mesh that decide whether it bounds a solid.
struct MeshCheck {
  std::size_t vertices = 0;  ///< used by a triangle
  std::size_t triangles = 0;
  std::size_t components = 0;           ///< connected over shared vertices
  std::size_t boundaryEdges = 0;        ///< used once
  std::size_t nonManifoldEdges = 0;     ///< used more than twice
  std::size_t misorientedEdges = 0;     ///< used twice, both times in the same direction
  std::size_t nonManifoldVertices = 0;  ///< whose triangles form more than one fan
  std::size_t selfIntersections = 0;    ///< pairs of triangles that cross or overlap away from shared corners
  bool allSelfIntersections = true;     ///< false: too many boxes overlap, and there may be more of them
  bool closed = false;                  ///< no boundary edge
  bool manifold = false;                ///< no non-manifold edge or vertex
  bool oriented = false;                ///< every manifold edge used once in each direction
  std::optional<long> genus;  ///< total over the components; only for a closed, manifold, oriented mesh
  double area = 0;
  double volume = 0;  ///< signed; meaningful when closed and oriented
  Eigen::AlignedBox3d bounds;
};

[[nodiscard]] MeshCheck checkMesh(const medial::TriangleMesh& mesh);

}  // namespace spheretree::io
