// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "builders/cell_blocks.hpp"
#include "builders/cover_table.hpp"
#include "builders/inward.hpp"
#include "builders/reducer.hpp"
#include "medial/ball.hpp"
#include "medial/random.hpp"

namespace spheretree::builders {

/// The least stand-off d for which a few balls of radius depth + d hold all cells of a region, and the balls:
/// what the reducers expand and spawn have in common. They differ in where their candidates come from.
///
/// Add candidates to the table, start, finish. The request must outlive the search.
class StandOffSearch {
 public:
  explicit StandOffSearch(const ReduceRequest& request);

  /// Some cells of the region, spread evenly over its area, against the candidates.
  [[nodiscard]] CoverTable& table() noexcept { return table_; }
  [[nodiscard]] const Eigen::AlignedBox3d& box() const noexcept { return box_; }  ///< of the cells

  /// The middle of a cell.
  [[nodiscard]] Eigen::Vector3d middleOf(std::uint32_t cell) const;
  /// The largest ball inside the solid that touches the surface at the middle of a cell.
  [[nodiscard]] Candidate growFrom(std::uint32_t cell) const;

  /// Takes the greedy cover at the least stand-off that one is found for. There must be a candidate.
  void startGreedily();
  /// Nearly the least stand-off that something succeeds at, given one that it does succeed at.
  [[nodiscard]] double bisect(double high, const std::function<bool(double)>& succeeds);
  /// Takes candidates, at most maxBalls, whose balls of this stand-off hold the rows of the table.
  void startFrom(std::vector<std::uint32_t> chosen, double standOff);

  /// Better and better sets until that gets hard: between one and maxBalls balls of equal stand-off, each
  /// cell in one of them. When a good enough stand-off was asked for and found, the fewest balls of it.
  [[nodiscard]] std::vector<medial::Ball> finish();

 private:
  /// Which ball a row of the table leans on: the one that it asks the least stand-off of.
  struct Shares {
    std::vector<float> least;          // by row
    std::vector<std::uint32_t> owner;  // by row: index into chosen_
  };

  double startFarthestFirst();
  bool coverAll(double standOff, std::uint32_t most);
  void descend(double floor);
  void takeFewest(double standOff);
  void enrich(double standOff, double move);
  void jump(const Candidate& ball, std::span<const Eigen::Vector3d> points, double length);
  void growWhereNothingReaches();
  void lowerMean(double limit);
  [[nodiscard]] std::vector<Candidate> chosenBalls() const;
  [[nodiscard]] Shares shares();
  [[nodiscard]] double leastForRows() const;
  [[nodiscard]] std::vector<Eigen::Vector3d> cornersOf(std::span<const std::uint32_t> rows) const;

  const ReduceRequest& request_;
  std::uint32_t most_;  // balls
  medial::Random random_;
  Eigen::AlignedBox3d box_;
  double size_;  // diagonal of box_
  CoverTable table_;
  CellBlocks blocks_;
  std::vector<std::uint32_t> chosen_;  // candidates
  double standOff_;                    // at which the chosen ones hold all cells, once they do
};

}  // namespace spheretree::builders
