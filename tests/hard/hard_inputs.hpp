// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "medial/triangle_mesh.hpp"

namespace spheretree::test {

/// An input that is hard on a program: a mesh to be written as it is, or the bytes of a file. What has to
/// come of it says tests/hard/cases.csv.
struct HardInput {
  std::string_view file;  ///< name and ending: which reader gets it
  medial::TriangleMesh (*mesh)() = nullptr;
  std::string (*bytes)() = nullptr;  ///< used when there is no mesh
};

/// Meshes that are exact in what is wrong with them.
[[nodiscard]] std::span<const HardInput> hardMeshes();

/// Files that no writer of meshes would make.
[[nodiscard]] std::span<const HardInput> brokenFiles();

}  // namespace spheretree::test
