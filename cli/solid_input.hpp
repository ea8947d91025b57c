// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <Eigen/Core>

#include <spheretree/result.hpp>

#include "io/mesh_repair.hpp"
#include "io/tree_files.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::cli {

/// Where the origin of a tree's coordinates is.
enum class Frame : std::uint8_t {
  Mesh,       ///< where the mesh has it
  BoxCentred  ///< in the middle of the mesh's bounding box, as the classic toolkit writes
};

struct SolidInput {
  medial::Surface surface;  ///< in the frame asked for
  io::Provenance provenance;
  Eigen::Vector3d shift;  ///< was subtracted from the vertices; 0 in the frame of the mesh
};

/// Reads a mesh, repairs it by the rule, and indexes it. Errors: UnreadableInput, UnsuitableMesh, each with
/// the file's name.
Result<SolidInput> readSolid(const std::filesystem::path& mesh, io::Repair rule, Frame frame,
                             const medial::Context& context);

/// One line about the mesh and the repair rule that was used.
[[nodiscard]] std::string describeMesh(const io::Provenance& provenance);

/// A sentence when repairing changed the shape, otherwise empty.
[[nodiscard]] std::string shapeWarning(const io::Provenance& provenance);

/// What importing did, for `--verbose`.
[[nodiscard]] std::string describeImport(const io::Provenance& provenance);

}  // namespace spheretree::cli
