// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include <spheretree/pair_query.hpp>
#include <spheretree/pose.hpp>
#include <spheretree/query_tree.hpp>

namespace spheretree {

/// What is known of a distance, world units.
struct DistanceBounds {
  float lower = 0;        ///< no two points of the surfaces are closer
  float upper = 0;        ///< the solids are not farther apart; holds as far as QueryTree::standOff does
  bool complete = false;  ///< false: the budget ended the search; the bounds hold all the same
  std::uint64_t sphereTests = 0;
};

/// The distance between two solids, from their trees. The gap between the bounds is at most the stand-offs of
/// the deepest level (and rounding) when complete; 0 is the lower bound of trees that overlap.
///
/// Branch and bound, the nearest pair of nodes first, no pair that cannot come nearer than what was found.
/// Poses and limits as for PairQuery; with more budget neither bound gets worse. Nothing from the heap, any
/// thread.
[[nodiscard]] DistanceBounds distanceBetween(const QueryTree& a, const Pose& poseA, const QueryTree& b,
                                             const Pose& poseB, const QueryLimits& limits = {}) noexcept;

}  // namespace spheretree
