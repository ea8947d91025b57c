// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "builders/clusters.hpp"
#include "builders/fit_ball.hpp"
#include "builders/reducer.hpp"
#include "builders/units.hpp"
#include "medial/ball.hpp"

namespace spheretree::builders {

/// Clusters of the units in, at most so many out (at least one), all units still between them.
using ReduceTo = std::function<std::vector<Cluster>(const Units&, std::vector<Cluster>, std::size_t)>;

/// How a centre follows when its ball got other cells.
inline constexpr FitEffort kFollow{4, 5e-3};

/// The way from the medial balls of a region to few balls. `coarse` takes most of them away, where not much
/// depends on each, with units of several cells. Then everything is shared out anew, cell by cell, and `fine`
/// does the rest. At the end the cells are shared out again and the centres follow. With goodEnough the balls
/// get fewer as long as none of them sticks out more than that.
[[nodiscard]] std::vector<medial::Ball> reduceInStages(const ReduceRequest& request, const ReduceTo& coarse,
                                                       const ReduceTo& fine);

}  // namespace spheretree::builders
