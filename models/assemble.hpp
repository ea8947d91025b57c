// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "medial/triangle_mesh.hpp"

namespace spheretree::models {

/// The mesh shifted by `offset`.
[[nodiscard]] medial::TriangleMesh moved(medial::TriangleMesh mesh, const Eigen::Vector3d& offset);

/// Both meshes in one, the triangles of `first` first. No vertex is shared between them.
[[nodiscard]] medial::TriangleMesh joined(medial::TriangleMesh first, const medial::TriangleMesh& second);

/// The mesh turned inside out.
[[nodiscard]] medial::TriangleMesh reversed(medial::TriangleMesh mesh);

}  // namespace spheretree::models
