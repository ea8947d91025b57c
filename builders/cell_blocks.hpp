// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "builders/cell_lanes.hpp"
#include "builders/inward.hpp"
#include "medial/cell_set.hpp"

namespace spheretree::builders {

/// All cells of a region in runs that lie close together, to see fast how far balls must stand off.
class CellBlocks {
 public:
  /// `middle` should be that of the region.
  CellBlocks(const medial::CellSet& cells, const Eigen::Vector3d& middle);

  struct Check {
    double worst = 0;                  ///< the stand-off that the balls need, or `atLeast` when that is more
    std::vector<std::uint32_t> worse;  ///< per ball at most one of its cells that needs more than `limit`
  };

  /// The least stand-off with which the balls of these candidates hold all cells, known to be `atLeast` or
  /// more, in single precision. The nearer the two are, the faster.
  [[nodiscard]] Check check(std::span<const Candidate> balls, double atLeast, double limit);

  /// A stand-off with which the balls of these candidates do hold all cells, and no less than rounding can
  /// tell.
  [[nodiscard]] double standOff(std::span<const Candidate> balls);

 private:
  struct Extent {
    Point32 middle;
    float radius = 0;
  };
  struct Block {
    Extent extent;
    std::uint32_t firstPoint = 0;  // in points_
    std::uint32_t likely = 0;      // the ball that held it last time
  };
  void addBlock(std::span<const std::uint32_t> own, std::span<const Point32> points);
  void addGroups();
  void prepare(std::span<const Candidate> balls);
  /// Whether a ball of this stand-off holds all of a block.
  [[nodiscard]] bool holds(std::uint32_t ball, std::size_t block, float standOff) const;
  /// Fills near_: the balls that may need the least stand-off for a cell of the block; none when one of them
  /// holds all of it within `worst`.
  void findNear(std::size_t block, float worst);
  /// Those of the balls `from` that may need the least stand-off for something within an extent, the best
  /// guess first.
  void select(const Extent& extent, const std::vector<std::uint32_t>& from, std::vector<std::uint32_t>& to);
  [[nodiscard]] std::size_t endOf(std::size_t block) const;

  const medial::CellSet& cells_;
  Eigen::Vector3d middle_;
  CellLanes lanes_;
  std::vector<Block> blocks_;                 // and one more for the end of the points
  std::vector<Extent> groups_;                // of blocks
  std::array<std::vector<float>, 3> points_;  // corners of the blocks, each once per block
  // The balls being checked, and what is near of them.
  std::vector<Point32> centers_;
  std::vector<float> depths_;
  std::vector<std::uint32_t> all_;
  std::size_t group_ = 0;  // that nearGroup_ is about
  std::vector<std::uint32_t> nearGroup_;
  std::vector<std::uint32_t> near_;
  std::vector<float> estimate_;  // scratch of select
};

}  // namespace spheretree::builders
