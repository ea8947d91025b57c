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

/// The walk of a SIMD path. All of them give the same bits.
[[nodiscard]] WalkFunction walkPath(SimdLevel level) noexcept;

}  // namespace spheretree::detail
