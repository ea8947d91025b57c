// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

struct FilledMesh {
  medial::TriangleMesh mesh;
  std::size_t holes = 0;  ///< closed by new triangles
  std::size_t newTriangles = 0;
  std::size_t openHoles = 0;  ///< that could not be triangulated
};

/// Triangulates every hole of a mesh whose neighbours agree and whose edges have at most two triangles. No
/// vertex is added or moved; the new triangles come last.
[[nodiscard]] FilledMesh fillHoles(const medial::TriangleMesh& mesh);

struct WrappedMesh {
  medial::TriangleMesh mesh;
  double alpha = 0;     ///< openings narrower than this are closed over, mesh units
  double offset = 0;    ///< distance kept from the input, mesh units
  double standOff = 0;  ///< no point of the wrap is farther from the input than this, mesh units
};

/// An alpha wrap: a closed, manifold, outward mesh free of self-intersections that strictly contains all
/// triangles, however badly they fit together. Needs at least one triangle with an area.
[[nodiscard]] WrappedMesh wrapMesh(const medial::TriangleMesh& mesh);

}  // namespace spheretree::io
