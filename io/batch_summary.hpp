// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <spheretree/result.hpp>

#include "builders/settings.hpp"
#include "io/batch_run.hpp"

namespace spheretree::io {

// Summaries of batches (docs/batch.md). The JSON text is the full one; the other forms are made from it.

/// Everything about a run. `settings` are those of the request.
[[nodiscard]] std::string formatSummary(const BatchPlan& plan, const BatchOptions& options,
                                        const builders::BuildSettings& settings, const BatchResult& result);

/// A row per asset, header first, from the JSON text of a summary. Its last four columns are the clock's.
[[nodiscard]] std::string summaryCsv(std::string_view summaryJson);

/// A small picture per entry of `assets`, of the trees below `folder`; empty where there is none.
[[nodiscard]] std::vector<std::string> summaryThumbnails(std::string_view summaryJson,
                                                         const std::filesystem::path& folder);

/// The summaries of all shards as one, what a run of everything would have written but for the clock's
/// figures. Errors: UnreadableInput; InvalidArgument for files that are no summaries, shards that are
/// missing, there twice or of another batch, and assets that are there twice.
Result<std::string> mergeSummaries(const std::vector<std::filesystem::path>& paths);

/// The costs in a summary that stands there already; none when there is none.
[[nodiscard]] BuildCosts costsIn(const std::filesystem::path& summaryJson);

/// Whether a file may be replaced by a summary: it is not there, or it is one of the same form.
Result<Done> checkSummaryPlace(const std::filesystem::path& path);

/// How many assets of each state the JSON text of a summary counts.
struct BatchTotals {
  std::size_t assets = 0;
  std::size_t done = 0;
  std::size_t missed = 0;
  std::size_t failed = 0;
  std::size_t pending = 0;
};
[[nodiscard]] BatchTotals totalsOf(std::string_view summaryJson);

}  // namespace spheretree::io
