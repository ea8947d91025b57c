// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/stages.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

namespace spheretree::builders {
namespace {

// Size of the coarse units, as a fraction of the radius that the balls can be expected to have. Half of it
// takes twice as long and leads nowhere better; twice as much loses 4 % on the top level.
constexpr double kCoarseUnit = 0.7;
// But there must be enough of them to choose from, whatever the shape of the region.
constexpr std::size_t kUnitsPerBall = 12;
constexpr std::size_t kCentersPerBall = 8;
// Shares at the end: the first brings 10 %, the second 4, a third 1.
constexpr int kLastShares = 2;

Units coarseUnits(const ReduceRequest& request) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : request.cells.points()) box.extend(p);
  double size = kCoarseUnit * box.diagonal().norm() / 2 / std::sqrt(static_cast<double>(request.maxBalls));
  const std::size_t wanted = std::min(request.cells.size(), kUnitsPerBall * request.maxBalls);
  Units units(request.cells, size);
  // Halving a distance cannot go on for ever: in the end every cell is a unit.
  while (units.size() < wanted) {
    request.context.checkCancelled();
    size /= 2;
    units = Units(request.cells, size);
  }
  return units;
}

/// What the coarse stage leaves: half as many again, and a choice even where one ball is wanted.
std::size_t coarseTarget(std::size_t maxBalls) {
  return maxBalls + std::max<std::size_t>(maxBalls / 2, 2);
}

}  // namespace

std::vector<medial::Ball> reduceInStages(const ReduceRequest& request, const ReduceTo& coarse,
                                         const ReduceTo& fine) {
  const Units units = coarseUnits(request);
  std::vector<Cluster> clusters =
      medialClusters(request, units, request.axis, kCentersPerBall * request.maxBalls);
  clusters = coarse(units, std::move(clusters), coarseTarget(request.maxBalls));

  const Units cells(request.cells, 0);
  clusters = reshare(request, cells, clusters, kFollow);
  const auto reduceTo = [&](std::vector<Cluster> from, std::size_t wanted) {
    std::vector<Cluster> result = fine(cells, std::move(from), wanted);
    for (int i = 0; i < kLastShares; ++i) result = reshare(request, cells, result, kFollow);
    return result;
  };
  clusters = reduceTo(std::move(clusters), request.maxBalls);
  while (request.goodEnough > 0 && clusters.size() > 1 && worstOf(clusters) <= request.goodEnough) {
    std::vector<Cluster> fewer = reduceTo(clusters, clusters.size() - 1);
    if (worstOf(fewer) > request.goodEnough) break;
    clusters = std::move(fewer);
  }
  return ballsOf(clusters);
}

}  // namespace spheretree::builders
