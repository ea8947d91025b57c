// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "medial/cell_set.hpp"
#include "medial/context.hpp"
#include "medial/medial_axis.hpp"
#include "medial/surface.hpp"

namespace spheretree::medial {

// What makes a set of balls good candidates for covering cells: few, everywhere, and linked. The stand-off of
// a ball for a cell is how far it sticks out when it holds the cell: farthest corner - depth.

/// The mean of a cell's corners.
[[nodiscard]] Eigen::Vector3d middleOf(const CellSet& cells, std::size_t cell);

/// For each ball one that can stand for it, itself when it is kept: whatever the ball covers, the other one
/// covers as well with at most `tolerance` (mesh units) more stand-off. Deep balls first; `step`: depths
/// nearer to each other than this are equal, so that rounding does not decide. Nothing when more than `most`
/// balls would be kept. O(balls * kept).
[[nodiscard]] std::optional<std::vector<std::uint32_t>> thinOut(std::span<const MedialBall> balls,
                                                                double tolerance, double step,
                                                                std::size_t most);

/// Balls for cells that no ball covers with a stand-off of at most `standOff` (mesh units), each touching the
/// surface at the middle of its cell (in the solid: around it). Such a ball covers its cell with a stand-off
/// of at most the cell's radius, so with these every cell has a ball for the larger of the two lengths; a
/// cell of a triangle without area may stay as it is. Nothing when more than `most` are needed.
[[nodiscard]] std::optional<std::vector<MedialBall>> gapBalls(const Surface& surface, const CellSet& cells,
                                                              std::span<const MedialBall> balls,
                                                              double standOff, std::size_t most,
                                                              const Context& context);

/// Pairs (a < b) of each ball from number `first` on with the few whose centres are nearest. `step`: lengths
/// nearer to each other than this are equal.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> linkNearest(std::span<const MedialBall> balls,
                                                                    std::size_t first, double step);

}  // namespace spheretree::medial
