// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "builders/cover.hpp"
#include "builders/metrics.hpp"
#include "builders/settings.hpp"
#include "io/tree_files.hpp"

namespace spheretree::io {

// What several reports say in the same words (docs/reports.md). The pieces are JSON texts, because headers
// carry no JSON library; whoever assembles a report parses them. Numbers survive that exactly.

/// `tool`: name, version, git revision.
[[nodiscard]] std::string toolJson();

/// `mesh`: path, content hash, facts, what importing and repairing did. Relative lengths are fractions of
/// the diagonal of provenance.check.bounds.
[[nodiscard]] std::string meshJson(const Provenance& provenance);

/// One entry of `levels`: everything measured, lengths in mesh units and as fractions of `diagonal`.
[[nodiscard]] std::string levelJson(std::size_t level, const builders::LevelMetrics& metrics,
                                    double diagonal);

/// The same entry as summaries and comparisons have it: upper bounds only, from its full text.
[[nodiscard]] std::string briefLevelJson(const std::string& levelJson);

/// One entry of `certificate`.
[[nodiscard]] std::string chainJson(const builders::ChainProof& proof);

/// A build's report without what a clock or the machine decides: threads, stages, memory. What is left is the
/// same whenever the same program builds the same mesh with the same settings.
[[nodiscard]] std::string withoutClock(const std::string& reportJson);

/// As in `--repair` and in reports.
[[nodiscard]] std::string repairName(Repair rule);

/// As in `--quality`, `--objective` and in reports.
[[nodiscard]] std::string qualityName(builders::Quality quality);
[[nodiscard]] std::string objectiveName(builders::Objective objective);

/// The shortest text that reads back as the same number.
[[nodiscard]] std::string exactNumber(double value);

/// A JSON value (null is empty, numbers exact) as a cell of comma-separated values, quoted where it must be.
[[nodiscard]] std::string csvCell(const std::string& jsonValue);

/// Six digits, enough to read.
[[nodiscard]] std::string readableNumber(double value);

/// The first line of a CSV report.
[[nodiscard]] std::string levelCsvHeader();

/// How many sets of a level each reducer won.
using Winners = std::vector<std::pair<std::string, std::size_t>>;

/// The line of one level.
[[nodiscard]] std::string levelCsvRow(std::size_t level, const builders::LevelMetrics& metrics,
                                      const Provenance& provenance, const std::string& treeHash,
                                      const Winners& winners = {});

}  // namespace spheretree::io
