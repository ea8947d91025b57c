// SPDX-License-Identifier: GPL-3.0-or-later
#include "models/assemble.hpp"

#include <cstdint>
#include <utility>

namespace spheretree::models {

using medial::TriangleMesh;

TriangleMesh moved(TriangleMesh mesh, const Eigen::Vector3d& offset) {
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex += offset;
  return mesh;
}

TriangleMesh joined(TriangleMesh first, const TriangleMesh& second) {
  const auto shift = static_cast<std::uint32_t>(first.vertices.size());
  first.vertices.insert(first.vertices.end(), second.vertices.begin(), second.vertices.end());
  for (const auto& [a, b, c] : second.triangles) first.triangles.push_back({a + shift, b + shift, c + shift});
  return first;
}

TriangleMesh reversed(TriangleMesh mesh) {
  for (TriangleMesh::Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

}  // namespace spheretree::models
