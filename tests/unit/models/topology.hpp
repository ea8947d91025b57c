// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "medial/triangle_mesh.hpp"

namespace spheretree::tests {

/// Counts over the edges of a mesh, made without the code under test.
struct Topology {
  std::size_t vertices = 0;  ///< used by a triangle
  std::size_t edges = 0;     ///< undirected
  std::size_t faces = 0;
  std::size_t openEdges = 0;        ///< used by one triangle
  std::size_t crowdedEdges = 0;     ///< used by more than two
  std::size_t unbalancedEdges = 0;  ///< not used as often in one direction as in the other
  std::size_t shells = 0;           ///< connected over edges

  [[nodiscard]] long euler() const {
    return static_cast<long>(vertices) - static_cast<long>(edges) + static_cast<long>(faces);
  }
};

[[nodiscard]] Topology topologyOf(const medial::TriangleMesh& mesh);

/// True when every corner index is in range and no triangle names a vertex twice.
[[nodiscard]] bool hasValidIndices(const medial::TriangleMesh& mesh);

}  // namespace spheretree::tests
