// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/tree_levels.hpp"

namespace spheretree::io {

LevelNodes nodesAtLevel(const SphereTree& tree, std::size_t depth) {
  LevelNodes level;
  std::size_t place = 0;
  for (std::size_t above = 0; above <= depth; ++above) {
    for (const Node& node : tree.level(above)) {
      if (above == depth || node.childCount == 0) level.nodes.push_back(place);
      ++place;
    }
    if (above + 1 == depth) level.fromAbove = level.nodes.size();
  }
  return level;
}

}  // namespace spheretree::io
