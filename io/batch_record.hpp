// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <spheretree/result.hpp>

#include "io/batch_plan.hpp"

namespace spheretree::io {

/// What became of an asset.
enum class AssetState : std::uint8_t {
  Pending,  ///< not tried
  Done,
  Missed,  ///< built and written, but it sticks out farther than was asked for
  Failed
};

/// Why an asset is not Done.
enum class Trouble : std::uint8_t {
  None,
  UnreadableInput,
  UnsuitableMesh,
  ErrorBoundMissed,
  UnwritableOutput,
  Internal,
  Crashed,
  OutOfMemory,
  TimedOut
};

/// What is said about an asset beside its tree: a file of its own, which has the same bytes for every build
/// of the same mesh by the same program with the same settings.
struct AssetRecord {
  std::string fingerprint;  ///< fingerprintOf(); empty when the mesh could not even be read
  AssetState state = AssetState::Pending;
  Trouble trouble = Trouble::None;
  std::string reason;        ///< one sentence, empty for Done
  double patience = 0;       ///< TimedOut: after so many seconds
  std::string treeFileHash;  ///< contentHash() of the tree's file; empty when there is none
  std::string json;          ///< the whole file
};

/// Decides whether two builds would give the same: tool, content of the mesh, settings.
[[nodiscard]] std::string fingerprintOf(const BatchAsset& asset, const std::string& contentHash);

/// The record of an asset that has a tree. `report` is the JSON report of its build.
[[nodiscard]] AssetRecord recordOfTree(const BatchAsset& asset, const std::string& fingerprint,
                                       std::string_view report, std::string_view tree,
                                       const std::string& missedReason);

/// The record of an asset that has none.
[[nodiscard]] AssetRecord recordOfFailure(const BatchAsset& asset, const std::string& fingerprint,
                                          Trouble trouble, const std::string& reason, double patience = 0);

/// Errors: UnreadableInput when there is no such file, InvalidArgument when it is no record.
Result<AssetRecord> readRecord(const std::filesystem::path& path);

/// As in records and summaries: "done", "unsuitable_mesh".
[[nodiscard]] std::string stateName(AssetState state);
[[nodiscard]] std::string troubleName(Trouble trouble);

}  // namespace spheretree::io
