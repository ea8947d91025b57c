// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/units.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>

namespace spheretree::builders {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

Units::Units(const medial::CellSet& cells, double size) : pointCount_(cells.points().size()) {
  constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> listedBy(pointCount_, kNobody);  // the last unit that listed a point
  AlignedBox3d box;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    AlignedBox3d own;
    for (const std::uint32_t p : cells.corners(cell)) own.extend(cells.points()[p]);
    box.extend(own);
    if (cell > 0 && box.diagonal().squaredNorm() > size * size) {
      start_.push_back(static_cast<std::uint32_t>(numbers_.size()));
      box = own;
    }
    const auto unit = static_cast<std::uint32_t>(start_.size() - 1);
    for (const std::uint32_t p : cells.corners(cell)) {
      if (listedBy[p] == unit) continue;
      listedBy[p] = unit;
      numbers_.push_back(p);
      corners_.push_back(cells.points()[p]);
    }
  }
  if (!cells.empty()) start_.push_back(static_cast<std::uint32_t>(numbers_.size()));
}

double Units::farthestSquared(std::size_t unit, const Vector3d& center) const noexcept {
  double farthest = 0;
  for (const Vector3d& p : corners(unit)) farthest = std::max(farthest, (p - center).squaredNorm());
  return farthest;
}

}  // namespace spheretree::builders
