// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spheretree/sphere_tree.hpp>

#include "builders/metrics.hpp"
#include "builders/settings.hpp"

namespace spheretree::builders {

struct StageTime {
  std::string stage;
  double seconds = 0;  ///< wall clock; reported, never used
};

struct LevelReport {
  LevelMetrics metrics;
  /// How many sets of this level each reducer won, by name, in the order of the catalogue.
  std::vector<std::pair<std::string, std::size_t>> winners;
  /// Per ball, whose set it belongs to: a name of the catalogue, empty for the root and for balls that stand
  /// for themselves again.
  std::vector<std::string_view> makers{};
};

/// What there is to say about a build besides the tree itself.
struct BuildReport {
  BuildSettings settings;
  std::vector<LevelReport> levels;
  ChainProof surfaceChains;   ///< certified in every tree that buildTree returns
  ChainProof solidChains;     ///< proved for Cover::Solid only; otherwise not attempted
  bool errorBoundMet = true;  ///< false: maxError was set and the last level's worst overhang is above it
  /// Distance of neighbouring floats where the mesh is farthest from the origin, fraction of the diagonal: no
  /// ball of the tree is placed better than that.
  double coordinateStep = 0;
  std::vector<StageTime>
      stages;  ///< "build" is the builder alone, "certify" the proofs, "measure" the metrics
  unsigned threads = 1;
};

/// A tree and its report, always both.
struct BuildResult {
  SphereTree tree;
  BuildReport report;
};

}  // namespace spheretree::builders
