// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "builders/settings.hpp"

namespace spheretree::builders {

// What a build makes of its settings: which of them it looks at, and what `auto` means for it.

/// A sentence saying what is wrong with the settings; empty when nothing is.
[[nodiscard]] std::string whyInvalid(const BuildSettings& settings);

/// The same for the reducers of `combined` alone.
[[nodiscard]] std::string whyNoReducers(std::span<const std::string> names);

/// The names of the reducers that make the sets of balls, in the order of the catalogue; none for a builder
/// that works without (octree).
[[nodiscard]] std::vector<std::string_view> reducersInUse(const BuildSettings& settings);

/// Whether levels are refined after the reducers, and whether they are linked while that is done.
[[nodiscard]] bool refines(const BuildSettings& settings);
[[nodiscard]] bool links(const BuildSettings& settings);

/// Whether any reducer in use wants an adaptive medial axis.
[[nodiscard]] bool usesAxis(const BuildSettings& settings);

}  // namespace spheretree::builders
