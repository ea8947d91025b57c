// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace spheretree::builders {

/// What every level of the tree covers.
enum class Cover : std::uint8_t {
  Surface,  ///< every point of the boundary: enough to see that two surfaces cross
  Solid     ///< every point of the solid: also sees an object swallowed whole by another one
};

/// Static medial axis and greedy merging (docs/builders/hubbard.md).
struct HubbardSettings {
  std::uint32_t samples = 2000;  ///< surface samples for the static medial axis; more is tighter and slower
};

/// Optimised grids (docs/builders/grid.md).
struct GridSettings {
  std::uint32_t orientations = 12;  ///< orientations tried per node besides the axes of the mesh
};

/// Everything that decides the bytes of a tree, with the only defaults there are.
struct BuildSettings {
  std::string builder = "hubbard";  ///< a name of the catalogue (`spheretree list`)
  std::uint32_t branch = 8;         ///< most children of a node, at least 2
  std::uint32_t levels = 4;         ///< levels wanted, the root included, at least 1
  double maxError = 0;  ///< a ball with at most this overhang (fraction of the diagonal) is not refined
  Cover cover = Cover::Surface;
  std::uint64_t seed = 1;  ///< feeds every random choice; the same seed gives the same bytes
  HubbardSettings hubbard;
  GridSettings grid;
};

/// What buildTree accepts; the command line shows it.
struct SettingLimits {
  static constexpr std::uint32_t kLeastBranch = 2;
  static constexpr std::uint32_t kMostBranch = 4096;
  static constexpr std::uint32_t kMostLevels = 24;  ///< deeper balls cannot be told apart in float
  static constexpr std::uint32_t kLeastSamples = 4;  ///< one tetrahedron
};

}  // namespace spheretree::builders
