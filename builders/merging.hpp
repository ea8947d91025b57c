// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "builders/clusters.hpp"
#include "builders/fit_ball.hpp"
#include "builders/reducer.hpp"

namespace spheretree::builders {

/// Where the centre of a merged ball is looked for.
enum class MergedCenter : std::uint8_t {
  Old,       ///< the better of the two old centres: costs no distance query
  Between,   ///< also the place between them
  Enclosing  ///< also the middle of the smallest ball around both
};

struct MergeRules {
  MergedCenter center = MergedCenter::Old;
  FitEffort walk{0, 0};  ///< of the centre after the merge (fitBall()); no queries: it stays
};

/// Merges neighbours, those with the least overhang of the merged ball first, until `wanted` clusters are
/// left, at least one. Ties go to the lowest numbers.
[[nodiscard]] std::vector<Cluster> mergeClusters(const ReduceRequest& request, std::vector<Cluster> clusters,
                                                 std::size_t wanted, const MergeRules& rules);

}  // namespace spheretree::builders
