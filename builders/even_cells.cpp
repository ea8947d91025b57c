// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/even_cells.hpp"

#include <Eigen/Geometry>

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;

/// The area of a piece of the surface; the box of anything else has a comparable one.
double sizeOf(const medial::CellSet& cells, std::size_t cell) {
  const auto corners = cells.corners(cell);
  const auto points = cells.points();
  if (corners.size() == 3) {
    const Vector3d& a = points[corners[0]];
    return (points[corners[1]] - a).cross(points[corners[2]] - a).norm() / 2;
  }
  Eigen::AlignedBox3d box;
  for (const std::uint32_t p : corners) box.extend(points[p]);
  return box.diagonal().squaredNorm() / 3;
}

}  // namespace

std::vector<std::uint32_t> evenCells(const medial::CellSet& cells, std::size_t count) {
  // Near the middle of a share, but nothing that halves of triangles add up to: a tie would be rounding's
  // to decide.
  constexpr double kPlace = 0.4816253;
  double total = 0;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) total += sizeOf(cells, cell);
  const double share = total / static_cast<double>(count);
  std::vector<std::uint32_t> chosen;
  double passed = 0;
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    passed += sizeOf(cells, cell);
    if (passed >= (static_cast<double>(chosen.size()) + kPlace) * share) chosen.push_back(cell);
  }
  return chosen;
}

}  // namespace spheretree::builders
