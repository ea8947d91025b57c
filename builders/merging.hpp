// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "builders/clusters.hpp"
#include "builders/reducer.hpp"

namespace spheretree::builders {

/// Where the centre of a merged ball is looked for.
enum class MergedCenter : std::uint8_t {
  Old,  ///< the better of the two old centres: no distance query
  Any,  ///< also between them and at the centre of the smallest ball
  Moved ///< as Any; after the merge it moves to where the ball sticks out less
};

/// Merges neighbours, those with the least overhang of the merged ball first, until `wanted` clusters are
/// left. Ties go to the lowest numbers.
[[nodiscard]] std::vector<Cluster> mergeClusters(const ReduceRequest& request, std::vector<Cluster> clusters,
                                                 std::size_t wanted, MergedCenter center);

}  // namespace spheretree::builders
