// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string_view>

namespace spheretree::builders {

/// One row per builder: what the command line, the docs and the typed tests read.
struct CatalogueEntry {
  std::string_view name;
  std::string_view summary;    ///< one line
  std::string_view reference;  ///< where the method comes from
};

[[nodiscard]] std::span<const CatalogueEntry> catalogue();

}  // namespace spheretree::builders
