// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstring>
#include <string_view>

#include <spheretree/sphere_tree.hpp>

#include "builders/settings.hpp"

namespace spheretree::test {

/// Whether two trees have the same balls, bit by bit, below the same parents.
inline bool sameBits(const SphereTree& a, const SphereTree& b) {
  if (a.nodes().size() != b.nodes().size()) return false;
  for (std::size_t i = 0; i < a.nodes().size(); ++i) {
    const Node& x = a.nodes()[i];
    const Node& y = b.nodes()[i];
    if (std::memcmp(&x.ball, &y.ball, sizeof x.ball) != 0 || x.parent != y.parent) return false;
  }
  return true;
}

/// Settings with which every builder is quick: facts that hold for any tree hold for coarse ones.
inline builders::BuildSettings quickSettings(std::string_view builder, std::uint32_t levels = 3) {
  builders::BuildSettings settings;
  settings.builder = builder;
  settings.levels = levels;
  settings.quality = builders::Quality::Fast;
  settings.axis = {1, 50};
  settings.hubbard.samples = 600;
  settings.grid.orientations = 2;
  return settings;
}

}  // namespace spheretree::test
