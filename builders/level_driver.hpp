// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "builders/ball_tree.hpp"
#include "builders/reducer.hpp"
#include "builders/settings.hpp"
#include "medial/context.hpp"
#include "medial/medial_axis.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

struct NamedReducer {
  std::string_view name;
  std::unique_ptr<Reducer> reducer;
};

/// Builds a tree level by level: the reducers cover the region of each node with its children and the set
/// with the lowest error stays, then every cell goes to the child that pays least for it, and the cells of a
/// child are its region. The nodes of one level are independent and run in parallel.
[[nodiscard]] BallTree buildByLevels(const medial::Surface& surface, const BuildSettings& settings,
                                     std::span<const NamedReducer> reducers, const medial::Context& context);

/// The refined medial axis of everything: what reducers choose the children of the root from.
[[nodiscard]] medial::MedialAxis rootAxis(const medial::Surface& surface, const BuildSettings& settings,
                                          const medial::Context& context);

/// The spherical octree: cubes split in halves, each that meets the surface (or the solid) in a ball.
[[nodiscard]] BallTree buildOctree(const medial::Surface& surface, const BuildSettings& settings,
                                   const medial::Context& context);

}  // namespace spheretree::builders
