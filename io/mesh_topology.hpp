// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// One side of a triangle, as a side of the undirected edge between two vertices.
struct EdgeUse {
  std::uint32_t low = 0;
  std::uint32_t high = 0;
  std::uint32_t triangle = 0;
  bool forward = true;  ///< the triangle goes from `low` to `high`
};

/// The sides of all triangles sorted by edge, then triangle: the uses of an edge are one run. O(n log n).
[[nodiscard]] std::vector<EdgeUse> sortedEdgeUses(const medial::TriangleMesh& mesh);

/// The first run of uses of one edge in a non-empty, sorted list.
[[nodiscard]] std::span<const EdgeUse> firstEdge(std::span<const EdgeUse> uses);

/// Disjoint sets of numbers, each known by its least member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count);
  void unite(std::uint32_t a, std::uint32_t b);
  /// The least member of the set of `a`.
  [[nodiscard]] std::uint32_t find(std::uint32_t a);

 private:
  std::vector<std::uint32_t> parent_;
};

/// How the triangles of a mesh hang together; nothing about where they are.
struct Topology {
  std::size_t vertices = 0;  ///< used by a triangle
  std::size_t edges = 0;
  std::size_t components = 0;  ///< connected over shared vertices
  std::size_t boundaryEdges = 0;
  std::size_t nonManifoldEdges = 0;
  std::size_t misorientedEdges = 0;
  std::size_t nonManifoldVertices = 0;
};

[[nodiscard]] Topology topologyOf(const medial::TriangleMesh& mesh);

}  // namespace spheretree::io
