// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

namespace spheretree::tests {
namespace {

struct EdgeUse {
  std::size_t forward = 0;
  std::size_t backward = 0;
  std::vector<std::size_t> faces;
};

std::size_t rootOf(std::vector<std::size_t>& parents, std::size_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

Topology topologyOf(const medial::TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, EdgeUse> edges;
  std::set<std::uint32_t> used;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][k];
      const std::uint32_t b = mesh.triangles[t][(k + 1) % 3];
      EdgeUse& use = edges[std::minmax(a, b)];
      ++(a < b ? use.forward : use.backward);
      use.faces.push_back(t);
      used.insert(a);
    }
  }
  Topology topology{.vertices = used.size(), .edges = edges.size(), .faces = mesh.triangles.size()};
  std::vector<std::size_t> parents(mesh.triangles.size());
  std::iota(parents.begin(), parents.end(), std::size_t{0});
  for (const auto& [edge, use] : edges) {
    topology.openEdges += use.faces.size() == 1 ? 1U : 0U;
    topology.crowdedEdges += use.faces.size() > 2 ? 1U : 0U;
    topology.unbalancedEdges += use.forward != use.backward ? 1U : 0U;
    for (const std::size_t face : use.faces)
      parents[rootOf(parents, face)] = rootOf(parents, use.faces.front());
  }
  for (std::size_t t = 0; t < parents.size(); ++t) topology.shells += rootOf(parents, t) == t ? 1U : 0U;
  return topology;
}

bool hasValidIndices(const medial::TriangleMesh& mesh) {
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const bool inRange = std::all_of(t.begin(), t.end(), [&](auto i) { return i < mesh.vertices.size(); });
    return inRange && t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
  });
}

}  // namespace spheretree::tests
