// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <spheretree/pose.hpp>
#include <spheretree/sphere_tree.hpp>

#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// Where two bodies stand.
struct PosePair {
  Pose a;
  Pose b;
};

/// Random poses of a mesh against itself in which the boxes of both overlap: what a broad phase hands on.
/// Both are turned, uniformly over all rotations. The same seed gives the same poses.
[[nodiscard]] std::vector<PosePair> closePoses(const medial::TriangleMesh& mesh, std::size_t count,
                                               std::uint64_t seed);

/// What a query costs on average.
struct PairCost {
  double microseconds = 0;  ///< wall clock, the best of several passes
  double sphereTests = 0;   ///< the same on every machine
};

/// Queries of a tree against itself in all poses, down to each of its levels in turn; one per level. Empty
/// for trees that queries do not accept (more than 16 levels).
[[nodiscard]] std::vector<PairCost> pairCosts(const SphereTree& tree, const std::vector<PosePair>& poses);

}  // namespace spheretree::io
