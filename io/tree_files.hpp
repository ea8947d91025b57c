// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include <spheretree/result.hpp>
#include <spheretree/sph.hpp>

#include "builders/report.hpp"
#include "io/files.hpp"
#include "io/mesh_check.hpp"
#include "io/mesh_import.hpp"
#include "io/mesh_repair.hpp"

namespace spheretree::io {

/// Where a tree came from: what its file and its report say besides the build itself.
struct Provenance {
  std::string meshPath;  ///< as the user gave it
  ImportReport import;
  MeshCheck check;  ///< of the mesh that the tree was built for, after repair
  Repair repair = Repair::Off;
  std::vector<std::string> repairActions;
  double wrapOffset = 0;
};

/// Reads a `.sph` file. Errors: UnreadableInput with file, line, reason.
Result<SphFile> readTree(const std::filesystem::path& path, SphLoadLimits limits = {});

/// The bytes of the strict `.sph` for a build, metadata included. The same build gives the same bytes: no
/// date, no host, no thread count.
Result<std::string> formatTree(const builders::BuildResult& build, const Provenance& provenance);

/// XXH3-128 over levels, parents and the bits of the balls: what the golden tests and reports compare.
[[nodiscard]] std::string treeHash(const SphereTree& tree);

/// The settings that a build looks at, decided, as reports have them: a JSON object.
[[nodiscard]] std::string settingsJson(const builders::BuildSettings& settings);

/// The full record of a build (docs/reports.md), pretty-printed JSON with a trailing newline.
[[nodiscard]] std::string formatJsonReport(const builders::BuildResult& build, const Provenance& provenance);

/// One row per level, header first.
[[nodiscard]] std::string formatCsvReport(const builders::BuildResult& build, const Provenance& provenance);

}  // namespace spheretree::io
