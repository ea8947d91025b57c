// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <spheretree/result.hpp>

#include "io/batch_journal.hpp"
#include "io/batch_plan.hpp"
#include "io/batch_record.hpp"
#include "io/files.hpp"
#include "io/tree_files.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::io {

enum class Pages : std::uint8_t { Without, With };
enum class OnFailure : std::uint8_t { KeepGoing, FailFast };

/// How much of the machine a batch may take, and when it gives up.
struct BatchLimits {
  unsigned jobs = 0;              ///< most assets at once; 0: as many as threads
  unsigned threads = 0;           ///< of all assets together; 0: all processors
  std::uint64_t memoryBytes = 0;  ///< of all assets together; 0: four fifths of what is free at the start
  double timeoutSeconds = 0;      ///< of one asset; 0: none
};

struct BatchOptions {
  std::filesystem::path folder;  ///< of the outputs, made if missing
  std::optional<Shard> shard;
  BatchLimits limits;
  Pages pages = Pages::Without;
  OnFailure onFailure = OnFailure::KeepGoing;
  Overwrite overwrite = Overwrite::Refuse;       ///< Replace: builds everything again
  std::vector<std::filesystem::path> summaries;  ///< files that will be written afterwards; for tidying up
};

/// What an asset's process makes.
struct BuiltAsset {
  std::string tree;    ///< bytes of the `.sph`
  std::string report;  ///< JSON report of the build
  std::string page;    ///< HTML, empty without
  std::string missed;  ///< sentence when the error asked for was not reached, else empty
};

/// Builds one asset, in a process of its own.
using BuildAsset = std::function<Result<BuiltAsset>(const BatchAsset&, unsigned threads)>;

/// The part of BuildAsset that comes after reading the mesh.
Result<BuiltAsset> buildAsset(const medial::Surface& surface, const Provenance& provenance,
                              const BatchAsset& asset, Pages pages, const medial::Context& context);

enum class AssetAction : std::uint8_t {
  None,     ///< not tried
  Skipped,  ///< its outputs were there already
  Built     ///< tried in this run, whatever came of it
};

/// What came of one asset.
struct AssetOutcome {
  AssetAction action = AssetAction::None;
  AssetRecord record;
  std::uint64_t memoryEstimate = 0;
  std::optional<BuildCost> cost;  ///< of the run that built it, if anybody knows
};

/// How far a batch is.
struct BatchProgress {
  std::size_t assets = 0;
  std::size_t settled = 0;  ///< skipped or built
  std::size_t skipped = 0;
  std::size_t failed = 0;  ///< of those settled
  double work = 0;         ///< of all assets to build; about seconds times a constant
  double workDone = 0;
  double seconds = 0;  ///< since the first asset was started
};

/// Called from the thread that runs the batch. Must not throw.
struct BatchObserver {
  std::function<void(const BatchAsset&, const AssetOutcome&, const BatchProgress&)> settled;
  std::function<void(const BatchProgress&)> waiting;  ///< several times a second
};

struct BatchResult {
  std::vector<AssetOutcome> outcomes;  ///< as the plan's assets
  BatchLimits limits;                  ///< as used
  double seconds = 0;
  bool stoppedEarly = false;  ///< OnFailure::FailFast came true
};

/// What would be done with an asset, without doing it.
struct AssetForecast {
  AssetAction action = AssetAction::Built;
  std::string reason;  ///< why it would fail; or, when skipped, why it failed before
  std::uint64_t triangleGuess = 0;
  std::uint64_t memoryEstimate = 0;
};
[[nodiscard]] std::vector<AssetForecast> forecastBatch(const BatchPlan& plan, const BatchOptions& options);

/// Builds what is not there yet: every asset in a child process, the largest first, within the limits. A
/// failed asset is an outcome, not an error. Writes trees, records and pages, each whole or not at all.
///
/// Errors: Cancelled, everything that was finished stays; UnwritableOutput when the folder cannot be used.
/// The caller has started no threads. `journal` is this folder's.
Result<BatchResult> runBatch(const BatchPlan& plan, const BatchOptions& options, const BuildAsset& build,
                             const BatchObserver& observer, BatchJournal& journal,
                             const medial::Context& context);

}  // namespace spheretree::io
