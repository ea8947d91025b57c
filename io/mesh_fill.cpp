// SPDX-License-Identifier: GPL-3.0-or-later
//
// Hole filling: P. Liepa, "Filling holes in meshes" (SGP 2003), in CGAL's form, with a plane Delaunay
// triangulation where the rim is nearly flat. The rim's own vertices only. Rims are followed here rather than
// in a halfedge mesh, because holes that touch in a vertex have to be told apart: a rim that comes back to a
// vertex is cut off there.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "io/mesh_closing.hpp"
#include "io/mesh_topology.hpp"

namespace spheretree::io {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangle = medial::TriangleMesh::Triangle;
using Rim = std::vector<std::uint32_t>;

// The search over all triangulations of a rim is cubic in its length: a second or so here, hours for ten
// times more. Longer rims are triangulated from the Delaunay tetrahedra of their points, or not at all.
constexpr std::size_t kLongestFullSearch = 500;

/// A missing triangle's side: against the direction of the triangle that is there.
struct RimEdge {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  bool used = false;
};

std::vector<RimEdge> rimEdges(const medial::TriangleMesh& mesh) {
  std::vector<RimEdge> edges;
  const std::vector<EdgeUse> uses = sortedEdgeUses(mesh);
  for (std::span<const EdgeUse> rest = uses; !rest.empty();) {
    const std::span<const EdgeUse> edge = firstEdge(rest);
    rest = rest.subspan(edge.size());
    if (edge.size() != 1) continue;
    const auto [from, to] =
        edge[0].forward ? std::pair(edge[0].high, edge[0].low) : std::pair(edge[0].low, edge[0].high);
    edges.push_back({from, to, false});
  }
  std::sort(edges.begin(), edges.end(), [](const RimEdge& a, const RimEdge& b) {
    return std::tie(a.from, a.to) < std::tie(b.from, b.to);
  });
  return edges;
}

/// The unused edge out of `at` that turns back most sharply from `before`: where holes touch, the one around
/// the same hole. Nothing when all are used.
RimEdge* nextEdge(const medial::TriangleMesh& mesh, std::vector<RimEdge>& edges, std::uint32_t before,
                  std::uint32_t at) {
  RimEdge* best = nullptr;
  double bestCosine = -std::numeric_limits<double>::infinity();
  auto edge =
      std::lower_bound(edges.begin(), edges.end(), at,
                       [](const RimEdge& candidate, std::uint32_t from) { return candidate.from < from; });
  const Eigen::Vector3d back = (mesh.vertices[before] - mesh.vertices[at]).normalized();
  for (; edge != edges.end() && edge->from == at; ++edge) {
    if (edge->used) continue;
    const double cosine = back.dot((mesh.vertices[edge->to] - mesh.vertices[at]).normalized());
    if (best != nullptr && !(cosine > bestCosine)) continue;
    best = &*edge;
    bestCosine = cosine;
  }
  return best;
}

/// Closed walks along the rims, none of which visits a vertex twice. In a mesh whose edges have at most two,
/// agreeing triangles as many rim edges end in a vertex as begin there, so no walk gets stuck.
std::vector<Rim> findRims(const medial::TriangleMesh& mesh) {
  std::vector<RimEdge> edges = rimEdges(mesh);
  std::vector<Rim> rims;
  std::vector<char> onWalk(mesh.vertices.size(), 0);
  for (RimEdge& start : edges) {
    if (start.used) continue;
    start.used = true;
    Rim walk = {start.from, start.to};
    onWalk[start.from] = onWalk[start.to] = 1;
    while (walk.size() > 1) {
      RimEdge* edge = nextEdge(mesh, edges, walk[walk.size() - 2], walk.back());
      if (edge == nullptr) break;
      edge->used = true;
      if (onWalk[edge->to] == 0) {
        walk.push_back(edge->to);
        onWalk[edge->to] = 1;
        continue;
      }
      const auto loop = std::find(walk.begin(), walk.end(), edge->to);
      rims.emplace_back(loop, walk.end());
      for (auto vertex = loop + 1; vertex != walk.end(); ++vertex) onWalk[*vertex] = 0;
      walk.erase(loop + 1, walk.end());
      // Back at a vertex of the walk, which goes on from there; its last edge tells where it came from.
    }
    for (const std::uint32_t vertex : walk) onWalk[vertex] = 0;
  }
  return rims;
}

/// Empty when the rim defies all methods.
std::vector<Triangle> triangulateRim(const medial::TriangleMesh& mesh, const Rim& rim) {
  if (rim.size() == 3) return {{rim[0], rim[1], rim[2]}};
  std::vector<Kernel::Point_3> points;
  for (const std::uint32_t vertex : rim) {
    const Eigen::Vector3d& p = mesh.vertices[vertex];
    points.emplace_back(p.x(), p.y(), p.z());
  }
  std::vector<CGAL::Triple<int, int, int>> faces;
  // The method for flat rims is quick, but walks out of its triangulation and crashes when a rim is flat and
  // crosses itself. Short rims do without it.
  const bool isLong = rim.size() > kLongestFullSearch;
  pmp::triangulate_hole_polyline(points, std::back_inserter(faces),
                                 CGAL::parameters::use_2d_constrained_delaunay_triangulation(isLong)
                                     .use_delaunay_triangulation(true)
                                     .do_not_use_cubic_algorithm(isLong));
  std::vector<Triangle> triangles;
  triangles.reserve(faces.size());
  for (const auto& face : faces) {
    triangles.push_back({rim[static_cast<std::size_t>(face.first)],
                         rim[static_cast<std::size_t>(face.second)],
                         rim[static_cast<std::size_t>(face.third)]});
  }
  return triangles;
}

}  // namespace

FilledMesh fillHoles(const medial::TriangleMesh& mesh) {
  FilledMesh filled;
  filled.mesh = mesh;
  for (const Rim& rim : findRims(mesh)) {
    const std::vector<Triangle> triangles = triangulateRim(mesh, rim);
    if (triangles.empty()) {
      ++filled.openHoles;
      continue;
    }
    ++filled.holes;
    filled.newTriangles += triangles.size();
    filled.mesh.triangles.insert(filled.mesh.triangles.end(), triangles.begin(), triangles.end());
  }
  return filled;
}

}  // namespace spheretree::io
