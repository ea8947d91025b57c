// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace spheretree::builders {

/// Single precision, relative to some middle that the owner of the numbers knows.
struct Point32 {
  float x = 0;
  float y = 0;
  float z = 0;
};

[[nodiscard]] inline Point32 toPoint32(const Eigen::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

/// The corners of cells side by side, so that their distances to one centre cost a few vector instructions.
/// Good enough to search with; what a search finds is judged in double precision afterwards.
class CellLanes {
 public:
  /// Appends a cell with at least one corner.
  void add(std::span<const Point32> corners);

  [[nodiscard]] std::size_t size() const noexcept { return first_.x.front().size(); }

  /// Squared distance from `center` to the farthest corner of each of the cells first, .., last - 1.
  void farthestSquared(std::size_t first, std::size_t last, const Point32& center,
                       std::vector<float>& out) const;

 private:
  struct Triples {
    std::array<std::vector<float>, 3> x;
    std::array<std::vector<float>, 3> y;
    std::array<std::vector<float>, 3> z;
    void add(const std::array<Point32, 3>& corners);
    void farthestSquared(std::size_t first, std::size_t last, const Point32& center, float* out) const;
  };

  Triples first_;                    // three corners of each cell: all of them for a piece of the surface
  Triples more_;                     // the others, three at a time
  std::vector<std::uint32_t> cell_;  // whose the triples of more_ are, ascending
};

}  // namespace spheretree::builders
