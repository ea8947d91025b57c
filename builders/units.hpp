// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "medial/cell_set.hpp"

namespace spheretree::builders {

/// A region cut into what is handed from ball to ball as a whole: cells that follow each other.
class Units {
 public:
  /// As many cells in a unit as stay within a box of diagonal `size`, at least one.
  Units(const medial::CellSet& cells, double size);

  [[nodiscard]] std::size_t size() const noexcept { return start_.size() - 1; }

  /// The corners of a unit, each once: a ball that holds them holds the unit.
  [[nodiscard]] std::span<const Eigen::Vector3d> corners(std::size_t unit) const noexcept {
    return std::span(corners_).subspan(start_[unit], start_[unit + 1] - start_[unit]);
  }

  /// The same by their numbers in CellSet::points(), of which there are pointCount().
  [[nodiscard]] std::span<const std::uint32_t> numbers(std::size_t unit) const noexcept {
    return std::span(numbers_).subspan(start_[unit], start_[unit + 1] - start_[unit]);
  }
  [[nodiscard]] std::size_t pointCount() const noexcept { return pointCount_; }

  /// Squared distance from `center` to the farthest corner.
  [[nodiscard]] double farthestSquared(std::size_t unit, const Eigen::Vector3d& center) const noexcept;

 private:
  std::vector<Eigen::Vector3d> corners_;
  std::vector<std::uint32_t> numbers_;
  std::vector<std::uint32_t> start_{0};
  std::size_t pointCount_;
};

}  // namespace spheretree::builders
