// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/cell_set.hpp"

#include <algorithm>
#include <tuple>

namespace spheretree::medial {
namespace {

auto coordinates(const Eigen::Vector3d& p) {
  return std::tuple(p.x(), p.y(), p.z());
}

// Edges that differ by rounding only are equal: halving a right-angled triangle makes such pairs all the time.
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
  std::vector<Eigen::Vector3d> corners;
  corners.reserve(3 * surface.size());
  start_.reserve(surface.size() + solid.size() + 1);
  for (const SurfaceCell& cell : surface) {
    corners.insert(corners.end(), cell.begin(), cell.end());
    start_.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  for (const SolidCell& cell : solid) {
    corners.insert(corners.end(), cell.points.begin(), cell.points.end());
    start_.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  // Equal positions become one point, numbered by first appearance.
  std::vector<std::uint32_t> order(corners.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto ca = coordinates(corners[a]);
    const auto cb = coordinates(corners[b]);
    return ca != cb ? ca < cb : a < b;
  });
  std::vector<std::uint32_t> representative(corners.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && coordinates(corners[order[i]]) == coordinates(corners[order[i - 1]]);
    representative[order[i]] = same ? representative[order[i - 1]] : order[i];
  }
  corners_.resize(corners.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    if (representative[i] == i) {
      corners_[i] = static_cast<std::uint32_t>(points_.size());
      points_.push_back(corners[i]);
    } else {
      corners_[i] = corners_[representative[i]];
    }
  }
}

double CellSet::farthestSquared(std::size_t cell, const Eigen::Vector3d& center) const {
  double farthest = 0;
  for (const std::uint32_t corner : corners(cell)) {
    farthest = std::max(farthest, (points_[corner] - center).squaredNorm());
  }
  return farthest;
}

}  // namespace spheretree::medial
