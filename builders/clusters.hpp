// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "builders/fit_ball.hpp"
#include "builders/reducer.hpp"
#include "medial/ball.hpp"
#include "medial/cell_set.hpp"
#include "medial/medial_axis.hpp"

namespace spheretree::builders {

/// What is handed from ball to ball as a whole: cells that follow each other in the region.
class Units {
 public:
  /// As many cells in a unit as stay within a box of diagonal `size`, at least one.
  Units(const medial::CellSet& cells, double size);

  [[nodiscard]] std::size_t size() const noexcept { return start_.size() - 1; }
  /// Corners of its cells, each once.
  [[nodiscard]] std::span<const Eigen::Vector3d> corners(std::size_t unit) const noexcept {
    return std::span(corners_).subspan(start_[unit], start_[unit + 1] - start_[unit]);
  }
  /// The same by their numbers in CellSet::points().
  [[nodiscard]] std::span<const std::uint32_t> ids(std::size_t unit) const noexcept {
    return std::span(ids_).subspan(start_[unit], start_[unit + 1] - start_[unit]);
  }
  [[nodiscard]] std::size_t idCount() const noexcept { return idCount_; }

  /// Squared distance from `center` to the farthest corner.
  [[nodiscard]] double farthestSquared(std::size_t unit, const Eigen::Vector3d& center) const;

 private:
  std::vector<Eigen::Vector3d> corners_;
  std::vector<std::uint32_t> ids_;
  std::vector<std::uint32_t> start_{0};
  std::size_t idCount_;
};

/// A ball and what it answers for.
struct Cluster {
  Fit fit;                                ///< the ball holds all of its units
  std::vector<std::uint32_t> units;       ///< numbers in a Units, in no particular order
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
/// apart is linked along a space-filling curve, so that everybody can reach everybody.
[[nodiscard]] std::vector<Cluster> medialClusters(const ReduceRequest& request, const Units& units,
                                                  const medial::MedialAxis& axis, std::size_t leastCenters);

/// Clusters in, at most so many out, with the same units between them.
using ReduceTo = std::function<std::vector<Cluster>(const Units&, std::vector<Cluster>, std::size_t)>;

/// The way from the medial balls of a region to few balls: `coarse` takes most of them away where nothing
/// much depends on each, with units of several cells; then everything is shared out anew, cell by cell, and
/// `fine` does the rest. At the end the cells are shared out again and the centres follow. With goodEnough
/// the balls get fewer as long as none of them sticks out more.
[[nodiscard]] std::vector<medial::Ball> reduceInStages(const ReduceRequest& request, const ReduceTo& coarse,
                                                       const ReduceTo& fine);

/// The clusters that have units left, renumbered.
[[nodiscard]] std::vector<Cluster> withoutEmpty(std::vector<Cluster> clusters);

[[nodiscard]] std::vector<medial::Ball> ballsOf(std::span<const Cluster> clusters);

}  // namespace spheretree::builders
