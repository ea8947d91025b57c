// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "builders/fit_ball.hpp"
#include "builders/reducer.hpp"
#include "builders/units.hpp"
#include "medial/ball.hpp"
#include "medial/medial_axis.hpp"

namespace spheretree::builders {

/// A ball and what it answers for.
struct Cluster {
  Fit fit;                                ///< the ball holds all of its units
  std::vector<std::uint32_t> units;       ///< numbers in a Units, in no particular order; never none
  PointBlock points;                      ///< their corners; some may be listed twice
  std::vector<std::uint32_t> neighbours;  ///< other clusters, ascending
};

/// Overhangs nearer to each other than this, in mesh units, are equal: which of two comes first must not hang
/// on rounding, or a turned object would get another tree.
[[nodiscard]] double costStep(const ReduceRequest& request);

/// Every unit goes to the medial ball that needs to stick out least for it; balls with units are clusters.
/// When fewer than `leastCenters` medial balls are near, the middles of so many runs of units are candidates
/// too.
///
/// Clusters are neighbours when their medial balls are, or when their units share a corner. What is still
/// apart is linked along a space-filling curve, so that everything can reach everything.
[[nodiscard]] std::vector<Cluster> medialClusters(const ReduceRequest& request, const Units& units,
                                                  const medial::MedialAxis& axis, std::size_t leastCenters);

/// Shares out all units anew, which need not be those that the clusters have, each to the centre that needs
/// to stick out least for it; then the centres follow (fitBall()). Clusters that get nothing vanish, those
/// that were neighbours stay neighbours. With the same units the largest overhang never grows.
[[nodiscard]] std::vector<Cluster> reshare(const ReduceRequest& request, const Units& units,
                                           std::span<const Cluster> clusters, const FitEffort& effort);

/// The clusters that have units, with their neighbours renumbered; the others must not be anybody's.
[[nodiscard]] std::vector<Cluster> withoutEmpty(std::vector<Cluster> clusters);

/// The largest overhang; 0 when nothing sticks out.
[[nodiscard]] double worstOf(std::span<const Cluster> clusters);

/// The balls, with radii that pass holds() for all they have to hold.
[[nodiscard]] std::vector<medial::Ball> ballsOf(std::span<const Cluster> clusters);

}  // namespace spheretree::builders
