// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <spheretree/result.hpp>

#include "builders/report.hpp"
#include "builders/settings.hpp"
#include "io/pair_timing.hpp"
#include "io/tree_files.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::io {

/// What is compared, and how it is measured.
struct CompareOptions {
  std::vector<std::string> builders;         ///< names of the catalogue
  std::vector<builders::Quality> qualities;  ///< of the builders that refine
  builders::BuildSettings settings;          ///< all the rest
  std::size_t poses = 2000;                  ///< close pairs that queries are timed on
  std::uint64_t poseSeed = 1;
};

/// A builder with its settings.
struct Contender {
  std::string name;  ///< "octree", "combined fast"
  builders::BuildSettings settings;
};

/// The contenders, in the order of the catalogue and of the qualities. A builder that does not look at the
/// quality is there once.
[[nodiscard]] std::vector<Contender> contendersOf(const CompareOptions& options);

struct ComparedLevel {
  builders::LevelMetrics metrics;
  std::optional<PairCost> cost;
  bool nonDominated = false;
};

/// What came of a contender.
struct ComparedRow {
  Contender contender;
  std::string reason;  ///< one sentence when it failed; then the rest is empty
  double buildSeconds = 0;
  std::size_t spheres = 0;
  std::string treeHash;
  std::vector<ComparedLevel> levels;

  [[nodiscard]] bool nonDominated() const { return !levels.empty() && levels.back().nonDominated; }
};

/// Builds a tree with every contender and measures it. A contender that fails is a row. A level is marked
/// when no other row has a level of the same depth with as few spheres, as small a worst overhang and as
/// short a build, one of them smaller.
///
/// Errors: Cancelled; InvalidArgument for settings that no build accepts.
Result<std::vector<ComparedRow>> compareBuilders(const medial::Surface& surface,
                                                 const CompareOptions& options,
                                                 const medial::Context& context);

/// The JSON of docs/compare.md.
[[nodiscard]] std::string formatComparison(const std::vector<ComparedRow>& rows,
                                           const CompareOptions& options, const Provenance& provenance,
                                           unsigned threads);

/// A row per contender and level, header first, from the JSON text.
[[nodiscard]] std::string comparisonCsv(std::string_view comparisonJson);

}  // namespace spheretree::io
