// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include <spheretree/result.hpp>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// What importing did to the file's triangles.
struct ImportReport {
  std::size_t meshes = 0;               ///< mesh instances merged, node transforms applied
  std::size_t polygons = 0;             ///< faces in the file
  std::size_t triangulated = 0;         ///< of these, with more than three corners
  std::size_t weldedVertices = 0;       ///< vertices that shared their position with an earlier one
  std::size_t degenerateTriangles = 0;  ///< dropped: two equal corners, or exactly zero area
  std::size_t duplicateTriangles = 0;   ///< dropped: same three corners as an earlier one, same orientation
  std::string contentHash;              ///< XXH3-128 of the file's bytes, 32 hex digits
};

struct ImportedMesh {
  medial::TriangleMesh mesh;
  ImportReport report;
};

/// Reads OBJ, PLY, STL, OFF, glTF/GLB, Collada, 3DS or FBX, whatever assimp recognises, in the file's own
/// units and frame. Errors: UnreadableInput, one sentence with file and reason.
Result<ImportedMesh> importMesh(const std::filesystem::path& path);

}  // namespace spheretree::io
