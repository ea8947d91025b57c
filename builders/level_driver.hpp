// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "builders/ball_tree.hpp"
#include "builders/reducer.hpp"
#include "builders/settings.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// Builds a tree level by level: the reducer covers the region of each node with its children, then every
/// cell goes to the child that pays least for it, and the cells of a child are its region. The nodes of one
/// level are independent and run in parallel.
[[nodiscard]] BallTree buildByLevels(const medial::Surface& surface, const BuildSettings& settings,
                                     std::string_view reducerName, const Reducer& reducer,
                                     const medial::Context& context);

/// The spherical octree: cubes split in halves, each that meets the surface (or the solid) in a ball.
[[nodiscard]] BallTree buildOctree(const medial::Surface& surface, const BuildSettings& settings,
                                   const medial::Context& context);

}  // namespace spheretree::builders
