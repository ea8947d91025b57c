// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a mesh is. Connectivity by sorted edges; self-intersections by A. Zomorodian and H. Edelsbrunner,
// "Fast software for box intersections" (2002), as CGAL has it, and exact predicates on the candidate pairs.
// Triangles that share corners meet there anyway, so only a contact elsewhere counts:
//   three common corners   one lies on the other;
//   two                    they overlap when both third corners lie in one plane, on the same side of the
//   edge; one                    they overlap when the edge opposite the corner in one of them meets the
//   other one; none                   any contact.

#include "io/mesh_check.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "io/mesh_topology.hpp"

namespace spheretree::io {
namespace {

using Triangle = medial::TriangleMesh::Triangle;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

class IntersectionTest {
 public:
  explicit IntersectionTest(const medial::TriangleMesh& mesh) : mesh_(mesh) {}

  bool operator()(std::uint32_t first, std::uint32_t second) const {
    // Common corners to the front, in the same order in both.
    Triangle a = mesh_.triangles[first];
    Triangle b = mesh_.triangles[second];
    std::size_t common = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = common; j < 3; ++j) {
        if (a[i] != b[j]) continue;
        std::swap(a[common], a[i]);
        std::swap(b[common], b[j]);
        ++common;
        break;
      }
    }
    switch (common) {
      case 0:
        return CGAL::do_intersect(triangle(a), triangle(b));
      case 1:
        return CGAL::do_intersect(triangle(a), Kernel::Segment_3(point(b[1]), point(b[2]))) ||
               CGAL::do_intersect(triangle(b), Kernel::Segment_3(point(a[1]), point(a[2])));
      case 2:
        return CGAL::coplanar(point(a[0]), point(a[1]), point(a[2]), point(b[2])) &&
               CGAL::coplanar_orientation(point(a[0]), point(a[1]), point(a[2]), point(b[2])) ==
                   CGAL::POSITIVE;
      default:
        return true;
    }
  }

 private:
  [[nodiscard]] Kernel::Point_3 point(std::uint32_t vertex) const {
    const Eigen::Vector3d& p = mesh_.vertices[vertex];
    return {p.x(), p.y(), p.z()};
  }
  [[nodiscard]] Kernel::Triangle_3 triangle(const Triangle& corners) const {
    return {point(corners[0]), point(corners[1]), point(corners[2])};
  }

  const medial::TriangleMesh& mesh_;
};

// Boxes that overlap are tried so often at most, per triangle and besides: all triangles around one vertex
// overlap there, and a hundred thousand of them make five thousand million pairs.
constexpr std::uint64_t kMostTriesPerTriangle = 100;
constexpr std::uint64_t kMostTries = 5'000'000;

struct TooManyTries {};

struct SelfIntersections {
  std::size_t count = 0;
  bool all = true;
};

SelfIntersections countSelfIntersections(const medial::TriangleMesh& mesh) {
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    // Without an area there is nothing to cross, and the predicates ask for triangles.
    if (CGAL::collinear(Kernel::Point_3(a.x(), a.y(), a.z()), Kernel::Point_3(b.x(), b.y(), b.z()),
                        Kernel::Point_3(c.x(), c.y(), c.z())))
      continue;
    const Eigen::Vector3d low = a.cwiseMin(b).cwiseMin(c);
    const Eigen::Vector3d high = a.cwiseMax(b).cwiseMax(c);
    boxes.emplace_back(CGAL::Bbox_3(low.x(), low.y(), low.z(), high.x(), high.y(), high.z()), t);
  }
  const IntersectionTest intersect(mesh);
  SelfIntersections found;
  std::uint64_t tries = kMostTries + kMostTriesPerTriangle * mesh.triangles.size();
  try {
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
      if (tries-- == 0) throw TooManyTries{};  // the algorithm itself cannot be stopped
      if (intersect(std::min(a.info(), b.info()), std::max(a.info(), b.info()))) ++found.count;
    });
  } catch (const TooManyTries&) {
    found.all = false;
  }
  return found;
}

}  // namespace

MeshCheck checkMesh(const medial::TriangleMesh& mesh) {
  const Topology topology = topologyOf(mesh);
  MeshCheck check;
  check.vertices = topology.vertices;
  check.triangles = mesh.triangles.size();
  check.components = topology.components;
  check.boundaryEdges = topology.boundaryEdges;
  check.nonManifoldEdges = topology.nonManifoldEdges;
  check.misorientedEdges = topology.misorientedEdges;
  check.nonManifoldVertices = topology.nonManifoldVertices;
  const SelfIntersections crossings = countSelfIntersections(mesh);
  check.selfIntersections = crossings.count;
  check.allSelfIntersections = crossings.all;
  check.closed = topology.boundaryEdges == 0;
  check.manifold = topology.nonManifoldEdges == 0 && topology.nonManifoldVertices == 0;
  check.oriented = topology.misorientedEdges == 0;
  if (check.closed && check.manifold && check.oriented) {
    // Euler and Poincare: V - E + F = 2 C - 2 g, summed over the components.
    const long characteristic = static_cast<long>(topology.vertices) - static_cast<long>(topology.edges) +
                                static_cast<long>(mesh.triangles.size());
    check.genus = static_cast<long>(topology.components) - characteristic / 2;
  }
  check.area = medial::areaOf(mesh);
  check.volume = medial::signedVolumeOf(mesh);
  check.bounds = medial::boundsOf(mesh);
  return check;
}

}  // namespace spheretree::io
