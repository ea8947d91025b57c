// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "builders/ball_tree.hpp"
#include "builders/reducer.hpp"
#include "builders/settings.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// One row per builder: what the command line, the docs and the typed tests read.
struct CatalogueEntry {
  std::string_view name;
  std::string_view summary;    ///< one line
  std::string_view reference;  ///< where the method comes from
  BallTree (*build)(const medial::Surface&, const BuildSettings&, const medial::Context&) = nullptr;
  /// How one region is covered, for rows that `combined` may choose from; nullptr for the others.
  std::unique_ptr<Reducer> (*makeReducer)(const medial::Surface&, const BuildSettings&,
                                          const medial::Context&) = nullptr;
};

/// All builders, from the plainest to the tightest.
[[nodiscard]] std::span<const CatalogueEntry> catalogue();

/// The row of that name, or nullptr.
[[nodiscard]] const CatalogueEntry* findBuilder(std::string_view name);

}  // namespace spheretree::builders
