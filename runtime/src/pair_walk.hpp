// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include <spheretree/pair_query.hpp>
#include <spheretree/simd.hpp>

namespace spheretree::detail {

/// Eight balls against eight.
inline constexpr std::uint64_t kTestsPerStep = std::uint64_t{kBlockLanes} * kBlockLanes;

/// Why a walk came back.
enum class WalkEnd : std::uint8_t { Found, Complete, OutOfBudget };

/// Where a walk has to stop.
struct WalkLimits {
  std::uint32_t level = 1;  // at least 1
  std::uint64_t tests = 0;  // value of PairWalk::tests at which to stop
};

/// Walks on until an overlap on the deepest level is on top of the walk, or nothing is left, or the budget
/// is.
using WalkFunction = WalkEnd (*)(PairWalk&, WalkLimits);

/// A box around the origin against a tree.
struct BoxWalk {
  Vec3 half;  // of the edges
  const QueryTree* tree = nullptr;
  BallPlacement placement;  // of the tree in the frame of the box
  std::uint32_t level = 1;  // whose balls decide, at least 1
  Sphere found;             // the placed ball that touches
};

/// Walks down to the first ball of the level that touches the box, the deepest of each family first. False
/// when none does. The root is not looked at.
using BoxWalkFunction = bool (*)(BoxWalk&);

struct WalkPaths {
  WalkFunction pair;
  BoxWalkFunction box;
};

/// The walks of a SIMD path. All of them give the same bits.
[[nodiscard]] WalkPaths walkPaths(SimdLevel level) noexcept;

}  // namespace spheretree::detail
