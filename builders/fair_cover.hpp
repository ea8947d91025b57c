// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builders/fit_ball.hpp"
#include "builders/pieces.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// A few balls that stick out no farther than a limit, placed so that they hold all pieces and can share out
/// the loads of these evenly: what several balls hold, any of them may take.
struct FairCoverRequest {
  const medial::Surface& surface;
  std::span<const Piece> pieces;
  std::span<const double> loads;       ///< one per piece, at least 0, not all 0
  std::span<const DepthProbe> places;  ///< where balls may jump to, not empty
  double limit = 0;                    ///< how far every ball sticks out, mesh units, greater than 0
  std::size_t steps = 1000;            ///< of the annealing
  std::uint64_t seed = 1;
};

struct FairCover {
  std::vector<DepthProbe> centers;
  double load = 0;        ///< the largest of any ball, when loads are shared as evenly as can be
  bool complete = false;  ///< every piece is in some ball
};

/// All subsets of the balls are looked at, so there may not be more.
inline constexpr std::size_t kMostFairBalls = 10;

/// Simulated annealing (S. Kirkpatrick et al. 1983) over the centres, from `start` (1 to kMostFairBalls).
/// Every ball reaches as far as the limit lets it. By P. Hall's theorem the largest load, shared as evenly as
/// can be, is the largest over all sets of balls of what only these hold, divided by their number.
[[nodiscard]] FairCover fairCover(const FairCoverRequest& request, std::span<const DepthProbe> start);

/// Of each piece, the ball of a complete cover that takes it: near each other and with even loads, as far as
/// whole pieces allow. Balls that hold much in vain get dearer until others take it (an auction, after D.
/// Bertsekas 1988).
[[nodiscard]] std::vector<std::uint32_t> shareFairly(const FairCoverRequest& request, const FairCover& cover);

}  // namespace spheretree::builders
