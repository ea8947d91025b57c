// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/cell_set.hpp"

#include <algorithm>
#include <utility>

#include "medial/place_index.hpp"

namespace spheretree::medial {
namespace {

// Edges that differ by rounding only are equal: halving a right-angled triangle makes such pairs all the
// time.
constexpr double kLonger = 1 + 1e-9;

}  // namespace

std::pair<SurfaceCell, SurfaceCell> bisect(const SurfaceCell& cell) {
  std::size_t longest = 0;
  double longestSquared = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double squared = (cell[(k + 1) % 3] - cell[k]).squaredNorm();
    if (squared > longestSquared * kLonger) {
      longestSquared = squared;
      longest = k;
    }
  }
  const Eigen::Vector3d& a = cell[longest];
  const Eigen::Vector3d& b = cell[(longest + 1) % 3];
  const Eigen::Vector3d& c = cell[(longest + 2) % 3];
  // Halving before adding is symmetric in a and b (two neighbours get the same bits) and cannot overflow.
  const Eigen::Vector3d middle = 0.5 * a + 0.5 * b;
  return {SurfaceCell{a, middle, c}, SurfaceCell{middle, b, c}};
}

double longestEdge(const SurfaceCell& cell) {
  return std::max({(cell[1] - cell[0]).norm(), (cell[2] - cell[1]).norm(), (cell[0] - cell[2]).norm()});
}

double areaOf(const SurfaceCell& cell) {
  return (cell[1] - cell[0]).cross(cell[2] - cell[0]).norm() / 2;
}

CellSet::CellSet(std::span<const SurfaceCell> surface, std::span<const SolidCell> solid) {
  std::vector<std::span<const Eigen::Vector3d>> cells;
  cells.reserve(surface.size() + solid.size());
  for (const SurfaceCell& cell : surface) cells.emplace_back(cell);
  for (const SolidCell& cell : solid) cells.emplace_back(cell.points);
  *this = CellSet(cells);
}

CellSet::CellSet(std::span<const std::span<const Eigen::Vector3d>> cells) {
  std::size_t count = 0;
  for (const std::span<const Eigen::Vector3d> cell : cells) count += cell.size();
  corners_.reserve(count);
  start_.reserve(cells.size() + 1);
  PlaceIndex number(count / 3);  // neighbours share most of their corners
  for (const std::span<const Eigen::Vector3d> cell : cells) {
    for (const Eigen::Vector3d& corner : cell) corners_.push_back(number(corner));
    start_.push_back(static_cast<std::uint32_t>(corners_.size()));
  }
  points_ = std::move(number).takePlaces();
}

double CellSet::farthestSquared(std::size_t cell, const Eigen::Vector3d& center) const {
  double farthest = 0;
  for (const std::uint32_t corner : corners(cell)) {
    farthest = std::max(farthest, (points_[corner] - center).squaredNorm());
  }
  return farthest;
}

}  // namespace spheretree::medial
