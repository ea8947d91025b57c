// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

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

/// How much work goes into a tree (docs/builders/combined.md has the price and the gain of each).
enum class Quality : std::uint8_t { Fast, Normal, Best };

/// What makes one set of balls better than another; ties go to the next in this order.
enum class Objective : std::uint8_t {
  Worst,  ///< the largest overhang of a ball
  Mean,   ///< the mean overhang of the balls
  Volume  ///< the volume of the union of the balls
};

enum class Toggle : std::uint8_t {
  Auto,  ///< on for `combined`, off for a reducer on its own
  Off,
  On
};

/// The adaptive medial axis of a region (docs/medial-axis.md).
struct AxisSettings {
  double error = 0.5;  ///< refined until no ball sticks out more than this fraction of the parent's overhang
  std::uint32_t leastBalls = 200;  ///< balls wanted per region
};

/// Which reducers compete for every set of balls (docs/builders/combined.md).
struct CombinedSettings {
  std::vector<std::string> reducers{"merge", "spawn"};  ///< names of the catalogue, each once
};

/// Everything that decides the bytes of a tree, with the only defaults there are.
struct BuildSettings {
  std::string builder = "combined";  ///< a name of the catalogue (`spheretree list`)
  std::uint32_t branch = 8;          ///< most children of a node, at least 2
  std::uint32_t levels = 4;          ///< levels wanted, the root included, at least 1
  double maxError = 0;  ///< a ball with at most this overhang (fraction of the diagonal) is not refined
  Cover cover = Cover::Surface;
  std::uint64_t seed = 1;  ///< feeds every random choice; the same seed gives the same bytes
  Quality quality = Quality::Normal;
  Objective objective = Objective::Worst;
  Toggle refine =
      Toggle::Auto;  ///< alternating minimax refinement after the reducers (docs/builders/refine.md)
  Toggle link =
      Toggle::Auto;  ///< regions of a level share their seams and their budget (docs/builders/refine.md)
  AxisSettings axis;
  CombinedSettings combined;
  HubbardSettings hubbard;
  GridSettings grid;
};

/// What buildTree accepts; the command line shows it.
struct SettingLimits {
  static constexpr std::uint32_t kLeastBranch = 2;
  static constexpr std::uint32_t kMostBranch = 4096;
  static constexpr std::uint32_t kMostLevels = 24;   ///< deeper balls cannot be told apart in float
  static constexpr std::uint32_t kLeastSamples = 4;  ///< one tetrahedron
};

}  // namespace spheretree::builders
