// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tree of boxes over runs of the list: runs of kRun points, then kFan boxes to a box.
#include "medial/near_points.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace spheretree::medial {
namespace {

constexpr std::size_t kRun = 8;
constexpr std::size_t kFan = 4;
constexpr std::size_t kStackSize = 128;  // kFan - 1 per level and 4^32 points at most

}  // namespace

NearPoints::NearPoints(std::span<const Eigen::Vector3d> points) : points_(points) {
  for (std::size_t first = 0; first < points.size(); first += kRun) {
    Eigen::AlignedBox3d& box = boxes_.emplace_back();
    for (const Eigen::Vector3d& p : points.subspan(first, std::min(kRun, points.size() - first)))
      box.extend(p);
  }
  levels_.push_back({0, boxes_.size()});
  while (levels_.back().count > 1) {
    const Level below = levels_.back();
    const std::size_t count = (below.count + kFan - 1) / kFan;
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::AlignedBox3d box;
      const std::size_t end = std::min(below.count, (i + 1) * kFan);
      for (std::size_t k = i * kFan; k < end; ++k) box.extend(boxes_[below.first + k]);
      boxes_.push_back(box);
    }
    levels_.push_back({below.first + below.count, count});
  }
}

bool NearPoints::anyWithin(const Eigen::Vector3d& place, double distance, std::size_t& last) const {
  if (points_.empty()) return false;
  const double limit = distance * distance;
  if (last < points_.size() && (points_[last] - place).squaredNorm() <= limit) return true;
  std::array<std::pair<std::size_t, std::size_t>, kStackSize> stack{};  // level, index in it
  std::size_t size = 0;
  stack[size++] = {levels_.size() - 1, 0};
  while (size > 0) {
    const auto [level, index] = stack[--size];
    const Eigen::AlignedBox3d& box = boxes_[levels_[level].first + index];
    if (box.squaredExteriorDistance(place) > limit) continue;
    if (level == 0) {
      const std::size_t first = index * kRun;
      for (std::size_t k = first; k < std::min(points_.size(), first + kRun); ++k) {
        if ((points_[k] - place).squaredNorm() > limit) continue;
        last = k;
        return true;
      }
      continue;
    }
    const std::size_t end = std::min(levels_[level - 1].count, (index + 1) * kFan);
    for (std::size_t k = index * kFan; k < end; ++k) stack[size++] = {level - 1, k};
  }
  return false;
}

}  // namespace spheretree::medial
