// SPDX-License-Identifier: GPL-3.0-or-later
//
// M. Garland and P. Heckbert, "Surface simplification using quadric error metrics" (SIGGRAPH 1997), in CGAL's
// form: collapses that would turn a triangle over, or change the topology, are refused. Works on a copy moved
// to the origin and scaled by a power of two, because quadrics square the coordinates.

#include "io/mesh_simplify.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <cmath>
#include <optional>
#include <string>

#include "io/cgal_bridge.hpp"
#include "io/guarded.hpp"
#include "io/mesh_topology.hpp"
#include "io/soup_cleaning.hpp"

namespace spheretree::io {
namespace {

namespace sms = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Quadrics = sms::GarlandHeckbert_plane_policies<Mesh, Kernel>;

constexpr std::size_t kTetrahedron = 4;  // no closed mesh has fewer triangles

void collapse(Mesh& mesh, std::size_t triangles) {
  const Quadrics quadrics(mesh);
  // A closed mesh has three edges for two triangles. The predicate stops below its number.
  const sms::Count_stop_predicate<Mesh> stop(triangles * 3 / 2 + 1);
  const sms::Bounded_normal_change_filter<> filter;
  sms::edge_collapse(
      mesh, stop,
      CGAL::parameters::get_cost(quadrics.get_cost()).get_placement(quadrics.get_placement()).filter(filter));
  mesh.collect_garbage();
}

}  // namespace

Result<medial::TriangleMesh> simplifyMesh(const medial::TriangleMesh& mesh, std::size_t triangles) {
  if (triangles < kTetrahedron)
    return Error{ErrorCode::InvalidArgument, "a closed mesh needs at least 4 triangles"};
  return guarded(ErrorCode::UnsuitableMesh, "simplification", [&]() -> Result<medial::TriangleMesh> {
    const Error unsuitable{ErrorCode::UnsuitableMesh,
                           "only a closed, manifold, oriented mesh can be simplified"};
    const Topology topology = topologyOf(mesh);
    if (mesh.triangles.empty() ||
        topology.boundaryEdges + topology.nonManifoldEdges + topology.nonManifoldVertices > 0)
      return unsuitable;
    if (mesh.triangles.size() <= triangles) return mesh;

    medial::TriangleMesh local = weldVertices(mesh);
    const Eigen::Vector3d origin = medial::boundsOf(mesh).center();
    const int exponent = std::ilogb(medial::diagonalOf(mesh));
    for (Eigen::Vector3d& vertex : local.vertices) vertex = (vertex - origin) * std::ldexp(1.0, -exponent);
    std::optional<Mesh> halfedges = toSurfaceMesh<Mesh>(local);
    if (!halfedges) return unsuitable;
    collapse(*halfedges, triangles);
    local = fromSurfaceMesh(*halfedges);
    for (Eigen::Vector3d& vertex : local.vertices) vertex = vertex * std::ldexp(1.0, exponent) + origin;
    return local;
  });
}

}  // namespace spheretree::io
