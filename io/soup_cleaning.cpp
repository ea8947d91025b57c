// SPDX-License-Identifier: GPL-3.0-or-later
//
// From polygons as files have them to an indexed triangle mesh: welding by position, triangulation, removal
// of what has no area or is there twice. Predicates are exact (CGAL), so nothing depends on a tolerance.
// Everything goes by sorting: same input, same output.

#include "io/soup_cleaning.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

namespace spheretree::io {
namespace {

using Triangle = medial::TriangleMesh::Triangle;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

// Splitting next to one sliver may leave another. Real files need one or two rounds; what is left then is
// dropped.
constexpr int kSliverRounds = 16;
// Where each sliver has one neighbour, triangles at most double. Crowds around one edge, with slivers in it,
// would multiply: a thousand of each become a million.
constexpr std::size_t kMostGrowth = 4;

Kernel::Point_3 exact(const Eigen::Vector3d& point) {
  return {point.x(), point.y(), point.z()};
}

std::array<double, 3> key(const Eigen::Vector3d& point) {
  return {point.x(), point.y(), point.z()};
}

// --- polygons ---

/// Newell's normal: twice the area, whatever the shape.
Eigen::Vector3d newellNormal(std::span<const Eigen::Vector3d> points,
                             std::span<const std::uint32_t> corners) {
  const Eigen::Vector3d& origin = points[corners[0]];
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    normal += (points[corners[k]] - origin).cross(points[corners[k + 1]] - origin);
  return normal;
}

std::vector<Triangle> cutQuadrilateral(std::span<const Eigen::Vector3d> points,
                                       std::span<const std::uint32_t> corners) {
  const Eigen::Vector3d normal = newellNormal(points, corners);
  const auto facing = [&](std::size_t i, std::size_t j, std::size_t k) {
    const Eigen::Vector3d& a = points[corners[i]];
    return (points[corners[j]] - a).cross(points[corners[k]] - a).dot(normal) > 0;
  };
  const auto lengthOf = [&](std::size_t i, std::size_t j) {
    return (points[corners[i]] - points[corners[j]]).squaredNorm();
  };
  const bool firstFits = facing(0, 1, 2) && facing(0, 2, 3);
  const bool secondFits = facing(1, 2, 3) && facing(1, 3, 0);
  const bool second = secondFits && (!firstFits || lengthOf(1, 3) < lengthOf(0, 2));
  if (second) return {{corners[1], corners[2], corners[3]}, {corners[1], corners[3], corners[0]}};
  return {{corners[0], corners[1], corners[2]}, {corners[0], corners[2], corners[3]}};
}

std::vector<Triangle> fan(std::span<const std::uint32_t> corners) {
  std::vector<Triangle> triangles;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    triangles.push_back({corners[0], corners[k], corners[k + 1]});
  return triangles;
}

struct Domain {
  int borders = -1;  ///< polygon edges between this face and infinity; odd inside
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel,
                                                CGAL::Triangulation_face_base_with_info_2<Domain, Kernel>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>, CGAL::No_constraint_intersection_tag>;

/// Counts for every face the polygon edges on the way to it from infinity.
void markDomains(Triangulation& triangulation) {
  std::vector<Triangulation::Face_handle> current = {triangulation.infinite_face()};
  std::vector<Triangulation::Face_handle> next;
  for (int borders = 0; !current.empty(); ++borders) {
    while (!current.empty()) {
      const Triangulation::Face_handle face = current.back();
      current.pop_back();
      if (face->info().borders >= 0) continue;
      face->info().borders = borders;
      for (int side = 0; side < 3; ++side) {
        const Triangulation::Face_handle neighbour = face->neighbor(side);
        if (neighbour->info().borders >= 0) continue;
        (face->is_constrained(side) ? next : current).push_back(neighbour);
      }
    }
    std::swap(current, next);
  }
}

/// Nothing when the projection of the polygon touches or crosses itself.
std::optional<std::vector<Triangle>> cutDelaunay(std::span<const Eigen::Vector3d> points,
                                                 std::span<const std::uint32_t> corners) {
  const Eigen::Vector3d normal = newellNormal(points, corners);
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  if (normal[axis] == 0) return std::nullopt;
  // Dropping a coordinate keeps the others exact. Seen from the positive side, unless the polygon looks away.
  const Eigen::Index u = (axis + (normal[axis] > 0 ? 1 : 2)) % 3;
  const Eigen::Index v = (axis + (normal[axis] > 0 ? 2 : 1)) % 3;
  Triangulation triangulation;
  try {
    std::vector<Triangulation::Vertex_handle> handles;
    for (const std::uint32_t corner : corners) {
      const Triangulation::Vertex_handle handle =
          triangulation.insert({points[corner][u], points[corner][v]});
      handle->info() = corner;
      handles.push_back(handle);
    }
    if (triangulation.number_of_vertices() != corners.size()) return std::nullopt;
    for (std::size_t k = 0; k < handles.size(); ++k)
      triangulation.insert_constraint(handles[k], handles[(k + 1) % handles.size()]);
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    return std::nullopt;
  }
  markDomains(triangulation);
  std::vector<Triangle> triangles;
  for (const Triangulation::Face_handle face : triangulation.finite_face_handles()) {
    if (face->info().borders % 2 == 1)
      triangles.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
  }
  if (triangles.size() != corners.size() - 2) return std::nullopt;  // a corner on another edge
  return triangles;
}

// --- triangles without area ---

bool hasEqualCorners(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// The place 0, 1 or 2 of the corner between the two others, for three corners on one line.
std::optional<std::size_t> middleCorner(const medial::TriangleMesh& mesh, const Triangle& t) {
  const std::array<Kernel::Point_3, 3> p = {exact(mesh.vertices[t[0]]), exact(mesh.vertices[t[1]]),
                                            exact(mesh.vertices[t[2]])};
  if (!CGAL::collinear(p[0], p[1], p[2])) return std::nullopt;
  for (std::size_t k = 0; k < 3; ++k)
    if (CGAL::collinear_are_ordered_along_line(p[(k + 2) % 3], p[k], p[(k + 1) % 3])) return k;
  return 0;
}

struct EdgeOfTriangle {
  std::uint32_t low;
  std::uint32_t high;
  std::size_t triangle;
};

bool operator<(const EdgeOfTriangle& a, const EdgeOfTriangle& b) {
  return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
}

std::vector<EdgeOfTriangle> sortedEdges(const medial::TriangleMesh& mesh) {
  std::vector<EdgeOfTriangle> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
      edges.push_back({low, high, t});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// `triangle` with its edge from `from` to `to` (or back) broken at `middle`.
std::array<Triangle, 2> splitAt(const Triangle& triangle, std::uint32_t from, std::uint32_t to,
                                std::uint32_t middle) {
  std::array<Triangle, 2> halves = {triangle, triangle};
  std::replace(halves[0].begin(), halves[0].end(), to, middle);
  std::replace(halves[1].begin(), halves[1].end(), from, middle);
  return halves;
}

std::size_t dropMarked(medial::TriangleMesh& mesh, const std::vector<char>& dropped) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (dropped[t] == 0) mesh.triangles[kept++] = mesh.triangles[t];
  const std::size_t count = mesh.triangles.size() - kept;
  mesh.triangles.resize(kept);
  return count;
}

std::size_t dropEqualCorners(medial::TriangleMesh& mesh) {
  std::vector<char> dropped(mesh.triangles.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    dropped[t] = hasEqualCorners(mesh.triangles[t]) ? 1 : 0;
  return dropMarked(mesh, dropped);
}

/// One round over the slivers that do not share a neighbour, as long as there are at most `most` triangles.
void dissolveSlivers(medial::TriangleMesh& mesh, std::span<const std::size_t> slivers, std::size_t most) {
  const std::vector<EdgeOfTriangle> edges = sortedEdges(mesh);
  std::vector<char> touched(mesh.triangles.size(), 0);
  std::vector<char> dropped(mesh.triangles.size(), 0);
  for (const std::size_t sliver : slivers) {
    const Triangle corners = mesh.triangles[sliver];
    const std::size_t middle = middleCorner(mesh, corners).value_or(0);
    const std::uint32_t from = corners[(middle + 1) % 3];
    const std::uint32_t to = corners[(middle + 2) % 3];
    const auto [low, high] = std::minmax(from, to);
    const auto begin = std::lower_bound(edges.begin(), edges.end(), EdgeOfTriangle{low, high, 0});
    auto end = begin;
    bool free = touched[sliver] == 0;
    for (; end != edges.end() && end->low == low && end->high == high; ++end)
      free = free && touched[end->triangle] == 0;
    if (!free) continue;  // its turn comes in the next round
    if (mesh.triangles.size() + static_cast<std::size_t>(end - begin) > most) continue;
    for (auto edge = begin; edge != end; ++edge) {
      touched[edge->triangle] = 1;
      if (edge->triangle == sliver) continue;
      const std::array<Triangle, 2> halves =
          splitAt(mesh.triangles[edge->triangle], from, to, corners[middle]);
      mesh.triangles[edge->triangle] = halves[0];
      mesh.triangles.push_back(halves[1]);
    }
    dropped[sliver] = 1;
  }
  dropped.resize(mesh.triangles.size(), 0);
  dropMarked(mesh, dropped);
}

std::vector<std::size_t> findSlivers(const medial::TriangleMesh& mesh) {
  std::vector<std::size_t> slivers;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (middleCorner(mesh, mesh.triangles[t])) slivers.push_back(t);
  return slivers;
}

}  // namespace

std::vector<std::uint32_t> firstAtSamePosition(std::span<const Eigen::Vector3d> points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::array<double, 3> keyA = key(points[a]);
    const std::array<double, 3> keyB = key(points[b]);
    return keyA != keyB ? keyA < keyB : a < b;
  });
  std::vector<std::uint32_t> first(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(points[order[i]]) == key(points[order[i - 1]]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

medial::TriangleMesh weldVertices(medial::TriangleMesh mesh) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  const std::vector<std::uint32_t> first = firstAtSamePosition(mesh.vertices);
  std::vector<std::uint32_t> place(mesh.vertices.size(), kUnused);
  for (Triangle& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) place[corner = first[corner]] = 0;
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (place[v] == kUnused) continue;
    place[v] = count;
    mesh.vertices[count++] = mesh.vertices[v] + Eigen::Vector3d::Zero();  // -0 + 0 is 0
  }
  mesh.vertices.resize(count);
  for (Triangle& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) corner = place[corner];
  return mesh;
}

std::vector<Triangle> triangulatePolygon(std::span<const Eigen::Vector3d> points,
                                         std::span<const std::uint32_t> corners) {
  if (corners.size() == 3) return {{corners[0], corners[1], corners[2]}};
  if (corners.size() == 4) return cutQuadrilateral(points, corners);
  if (std::optional<std::vector<Triangle>> triangles = cutDelaunay(points, corners))
    return std::move(*triangles);
  return fan(corners);
}

std::size_t removeDegenerate(medial::TriangleMesh& mesh) {
  std::size_t found = dropEqualCorners(mesh);
  const std::size_t most = kMostGrowth * mesh.triangles.size();
  for (int round = 0; round < kSliverRounds; ++round) {
    const std::vector<std::size_t> slivers = findSlivers(mesh);
    if (round == 0) found += slivers.size();
    if (slivers.empty()) return found;
    dissolveSlivers(mesh, slivers, most);
    dropEqualCorners(mesh);
  }
  std::vector<char> dropped(mesh.triangles.size(), 0);
  for (const std::size_t sliver : findSlivers(mesh)) dropped[sliver] = 1;
  dropMarked(mesh, dropped);
  return found;
}

std::size_t removeDuplicates(medial::TriangleMesh& mesh) {
  std::vector<std::pair<Triangle, std::size_t>> turned;
  turned.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle corners = mesh.triangles[t];
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    turned.emplace_back(corners, t);
  }
  std::sort(turned.begin(), turned.end());
  std::vector<char> dropped(mesh.triangles.size(), 0);
  for (std::size_t i = 1; i < turned.size(); ++i)
    dropped[turned[i].second] = turned[i].first == turned[i - 1].first ? 1 : 0;
  return dropMarked(mesh, dropped);
}

}  // namespace spheretree::io
