// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <spheretree/sphere_tree.hpp>

namespace spheretree::io {

/// The balls of a level, as places in SphereTree::nodes(), breadth-first.
struct LevelNodes {
  std::vector<std::size_t> nodes;
  std::size_t fromAbove = 0;  ///< how many of them lie above the level
};

/// What a search at that depth has in hand: the balls at that depth, and the childless balls above it, which
/// stand for themselves further down. `depth` must be below levelCount().
[[nodiscard]] LevelNodes nodesAtLevel(const SphereTree& tree, std::size_t depth);

}  // namespace spheretree::io
