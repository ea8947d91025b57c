// SPDX-License-Identifier: GPL-3.0-or-later
//
// Connectivity by sorting the sides of the triangles: no hashing, so the same mesh always gives the same
// order.

#include "io/mesh_topology.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace spheretree::io {
namespace {

using Triangle = medial::TriangleMesh::Triangle;

/// A fan is what remains connected around a vertex when triangles are joined over edges only. Triangle
/// corners are numbered 3 * triangle + place.
std::size_t countSplitVertices(const medial::TriangleMesh& mesh, std::span<const EdgeUse> uses) {
  DisjointSets fans(mesh.triangles.size() * 3);
  const auto cornerOf = [&](std::uint32_t triangle, std::uint32_t vertex) {
    const Triangle& corners = mesh.triangles[triangle];
    const auto place = std::find(corners.begin(), corners.end(), vertex) - corners.begin();
    return triangle * 3 + static_cast<std::uint32_t>(place);
  };
  for (std::span<const EdgeUse> rest = uses; !rest.empty();) {
    const std::span<const EdgeUse> edge = firstEdge(rest);
    for (std::size_t k = 1; k < edge.size(); ++k) {
      for (const std::uint32_t vertex : {edge[0].low, edge[0].high})
        fans.unite(cornerOf(edge[0].triangle, vertex), cornerOf(edge[k].triangle, vertex));
    }
    rest = rest.subspan(edge.size());
  }
  std::vector<std::uint32_t> fansAt(mesh.vertices.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k)
      if (fans.find(t * 3 + k) == t * 3 + k) ++fansAt[mesh.triangles[t][k]];
  }
  return static_cast<std::size_t>(
      std::count_if(fansAt.begin(), fansAt.end(), [](auto count) { return count > 1; }));
}

void countComponents(const medial::TriangleMesh& mesh, Topology& topology) {
  DisjointSets sets(mesh.vertices.size());
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) used[corner] = 1;
    sets.unite(triangle[0], triangle[1]);
    sets.unite(triangle[0], triangle[2]);
  }
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    if (used[v] == 0) continue;
    ++topology.vertices;
    if (sets.find(v) == v) ++topology.components;
  }
}

}  // namespace

std::vector<EdgeUse> sortedEdgeUses(const medial::TriangleMesh& mesh) {
  std::vector<EdgeUse> uses;
  uses.reserve(mesh.triangles.size() * 3);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.triangles[t][k];
      const std::uint32_t to = mesh.triangles[t][(k + 1) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.triangle, a.forward) < std::tie(b.low, b.high, b.triangle, b.forward);
  });
  return uses;
}

std::span<const EdgeUse> firstEdge(std::span<const EdgeUse> uses) {
  std::size_t end = 1;
  while (end < uses.size() && uses[end].low == uses[0].low && uses[end].high == uses[0].high) ++end;
  return uses.first(end);
}

DisjointSets::DisjointSets(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0U);
}

std::uint32_t DisjointSets::find(std::uint32_t a) {
  while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
  return a;
}

void DisjointSets::unite(std::uint32_t a, std::uint32_t b) {
  a = find(a);
  b = find(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

Topology topologyOf(const medial::TriangleMesh& mesh) {
  Topology topology;
  countComponents(mesh, topology);
  const std::vector<EdgeUse> uses = sortedEdgeUses(mesh);
  for (std::span<const EdgeUse> rest = uses; !rest.empty();) {
    const std::span<const EdgeUse> edge = firstEdge(rest);
    ++topology.edges;
    if (edge.size() == 1) ++topology.boundaryEdges;
    if (edge.size() > 2) ++topology.nonManifoldEdges;
    if (edge.size() == 2 && edge[0].forward == edge[1].forward) ++topology.misorientedEdges;
    rest = rest.subspan(edge.size());
  }
  topology.nonManifoldVertices = countSplitVertices(mesh, uses);
  return topology;
}

}  // namespace spheretree::io
