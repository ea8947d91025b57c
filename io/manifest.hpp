// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <spheretree/result.hpp>

#include "builders/settings.hpp"
#include "io/mesh_repair.hpp"

namespace spheretree::io {

/// What a manifest may say about an asset besides its name; the rest comes from the command line.
struct AssetSettings {
  std::optional<std::uint32_t> levels;
  std::optional<double> maxError;
  std::optional<std::uint32_t> branch;
  std::optional<std::string> builder;
  std::optional<builders::Quality> quality;
  std::optional<builders::Cover> cover;
  std::optional<Repair> repair;
};

/// How a scene uses an asset.
struct SceneUse {
  std::vector<double> scales;       ///< one per instance, scene units per mesh unit
  std::optional<double> tolerance;  ///< how far balls may stick out, scene units
};

/// One line of a manifest.
struct ManifestEntry {
  std::string place;                            ///< "list.csv: line 3", for sentences
  std::filesystem::path input;                  ///< relative names: to the manifest's folder
  std::optional<std::filesystem::path> output;  ///< relative to the output folder
  AssetSettings settings;
  std::optional<SceneUse> scene;  ///< when the manifest says scale, instances or tolerance
};

/// Reads a manifest (docs/batch.md), JSON or CSV by its ending. Unknown keys, values out of their range and
/// contradictions are refused. Errors: UnreadableInput when there is no such file, InvalidArgument; both with
/// file, place and reason.
Result<std::vector<ManifestEntry>> readManifest(const std::filesystem::path& path);

}  // namespace spheretree::io
