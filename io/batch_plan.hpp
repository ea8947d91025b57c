// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <spheretree/result.hpp>

#include "builders/settings.hpp"
#include "io/mesh_repair.hpp"

namespace spheretree::io {

/// How a scene uses an asset, summed up over its instances.
struct InstanceUse {
  std::size_t count = 0;
  double largestScale = 1;  ///< scene units per mesh unit
};

/// One mesh of a batch, and how it is to be built.
struct BatchAsset {
  std::filesystem::path input;
  std::string output;  ///< the tree, relative to the output folder
  builders::BuildSettings settings;
  Repair repair = Repair::Auto;
  /// How far balls may stick out, mesh units; replaces settings.maxError. 0: not given.
  double tolerance = 0;
  std::optional<InstanceUse> use;  ///< when a scene says so
  std::uint32_t fullLevels = 0;    ///< levels without a tolerance: what a scene's budget is compared with

  /// `chair.report.json` beside `chair.sph`, relative to the output folder.
  [[nodiscard]] std::string record() const;
  /// `chair.report.html`.
  [[nodiscard]] std::string page() const;
};

/// Part `index` of `count`, counted from 1.
struct Shard {
  std::uint32_t index = 1;
  std::uint32_t count = 1;
};

/// What a user asks a batch to do.
struct BatchRequest {
  std::vector<std::string> inputs;   ///< files, folders, patterns with * ? [], manifests
  std::vector<std::string> endings;  ///< of the files that are taken out of folders, with the dot
  builders::BuildSettings settings;  ///< for assets about which no manifest says more
  Repair repair = Repair::Auto;
  std::optional<std::uint32_t> levels;  ///< settings.levels, when somebody chose it
  std::optional<Shard> shard;
};

struct BatchPlan {
  std::vector<BatchAsset> assets;  ///< of the shard, sorted by output
  std::size_t ofAllShards = 0;
};

/// The endings of the formats that docs/mesh-input.md names.
[[nodiscard]] std::vector<std::string> meshEndings();

/// Finds the meshes and decides their outputs (docs/batch.md): folders and patterns are mirrored; where two
/// meshes would have the same tree, both keep their ending in its name. A scene's entries of the same mesh
/// and settings become one asset. The same files give the same plan, shard by shard.
///
/// Errors: UnreadableInput when an input is not there or holds no mesh; InvalidArgument for a wrong manifest
/// and for two meshes with one output; with the place.
Result<BatchPlan> planBatch(const BatchRequest& request);

}  // namespace spheretree::io
