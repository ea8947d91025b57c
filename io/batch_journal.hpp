// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <spheretree/result.hpp>

#include "io/batch_plan.hpp"

namespace spheretree::io {

/// What a clock says about the build of an asset.
struct BuildCost {
  double seconds = 0;
  std::uint64_t peakMemoryBytes = 0;
  unsigned threads = 0;
};

/// Costs by output.
using BuildCosts = std::map<std::string, BuildCost>;

/// A hidden file in the output folder while a batch runs. It keeps a second run of the same shard away, and
/// remembers what the assets cost until the summary says it: a killed run leaves it behind for the next one.
class BatchJournal {
 public:
  /// Locks the folder, and opens the journal. Errors: UnwritableOutput, when another run has it or the folder
  /// refuses.
  static Result<BatchJournal> open(const std::filesystem::path& folder, const std::optional<Shard>& shard);

  BatchJournal(BatchJournal&& other) noexcept;
  BatchJournal& operator=(BatchJournal&&) = delete;
  ~BatchJournal();

  /// What a killed run left. Its last line may be torn; that is left out.
  [[nodiscard]] const BuildCosts& costs() const noexcept { return costs_; }

  /// Costs from elsewhere; those of the journal are newer.
  void recall(const BuildCosts& older) { costs_.insert(older.begin(), older.end()); }

  /// Appends a line; when that fails, a figure is missing in the summary.
  void add(const std::string& output, const BuildCost& cost);

  /// The summary has it all now.
  void remove() noexcept;

 private:
  BatchJournal(std::filesystem::path path, int folder, int file) noexcept;

  std::filesystem::path path_;
  int folder_ = -1;
  int file_ = -1;
  BuildCosts costs_;
};

}  // namespace spheretree::io
