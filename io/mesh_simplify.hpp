// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include <spheretree/result.hpp>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// Edge collapse with Garland-Heckbert quadrics (CGAL) until at most `triangles` remain, or as few as the
/// topology allows. Fails with UnsuitableMesh for a mesh that is not closed and manifold, with
/// InvalidArgument for fewer than 4 triangles.
Result<medial::TriangleMesh> simplifyMesh(const medial::TriangleMesh& mesh, std::size_t triangles);

}  // namespace spheretree::io
