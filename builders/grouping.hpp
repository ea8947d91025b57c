// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builders/fit_ball.hpp"
#include "medial/context.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// A ball and the members that it holds, by number, ascending.
struct Group {
  Fit fit;
  std::vector<std::uint32_t> members;
};

/// Shares members out among balls, at most `capacity` to each, so that the balls stick out little; starts
/// from the given centres, which must suffice for all members. `members` are the points that each of them
/// must have held. Groups without members are left out. Same result for any number of threads.
[[nodiscard]] std::vector<Group> groupEvenly(const medial::Surface& surface,
                                             std::span<const PointBlock> members,
                                             std::span<const DepthProbe> centers, std::size_t capacity,
                                             const FitEffort& effort, const medial::Context& context);

/// `count` of the members far from each other, the first of them `first`: k-centre by farthest points (T.
/// Gonzalez 1985).
[[nodiscard]] std::vector<std::size_t> farApart(std::span<const Eigen::Vector3d> members, std::size_t first,
                                                std::size_t count);

}  // namespace spheretree::builders
