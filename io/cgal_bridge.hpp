// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

// Between our meshes and CGAL::Surface_mesh. Templates, so that no header has to know CGAL.

/// Nothing when an edge or a vertex is not manifold, or neighbours disagree.
template <class SurfaceMesh>
std::optional<SurfaceMesh> toSurfaceMesh(const medial::TriangleMesh& mesh) {
  using Vertex = typename SurfaceMesh::Vertex_index;
  SurfaceMesh result;
  std::vector<Vertex> vertices;
  vertices.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& p : mesh.vertices)
    vertices.push_back(result.add_vertex(typename SurfaceMesh::Point(p.x(), p.y(), p.z())));
  for (const auto& t : mesh.triangles) {
    if (result.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]) == SurfaceMesh::null_face())
      return std::nullopt;
  }
  return result;
}

/// The triangles in the order of the faces, removed elements left out.
template <class SurfaceMesh>
medial::TriangleMesh fromSurfaceMesh(const SurfaceMesh& mesh) {
  medial::TriangleMesh result;
  std::vector<std::uint32_t> place(mesh.num_vertices(), 0);
  for (const auto vertex : mesh.vertices()) {
    const auto index = static_cast<std::size_t>(vertex);
    if (index >= place.size()) place.resize(index + 1, 0);
    place[index] = static_cast<std::uint32_t>(result.vertices.size());
    const auto& p = mesh.point(vertex);
    result.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto face : mesh.faces()) {
    medial::TriangleMesh::Triangle triangle{};
    std::size_t k = 0;
    for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face)))
      triangle[k++] = place[static_cast<std::size_t>(vertex)];
    result.triangles.push_back(triangle);
  }
  return result;
}

}  // namespace spheretree::io
