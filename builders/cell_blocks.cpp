// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/cell_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;

// Cells that are looked at together: two vectors of the narrowest kind.
constexpr std::size_t kBlock = 8;
// Blocks for which the balls near by are looked up together.
constexpr std::size_t kGroup = 16;

}  // namespace

CellBlocks::CellBlocks(const medial::CellSet& cells, const Vector3d& middle)
    : cells_(cells), middle_(middle) {
  std::vector<Point32> points;
  points.reserve(cells.points().size());
  for (const Vector3d& p : cells.points()) points.push_back(toPoint32(p - middle));
  std::vector<Point32> corners;
  std::vector<std::uint32_t> own;
  for (std::size_t first = 0; first < cells.size(); first += kBlock) {
    own.clear();
    for (std::size_t cell = first; cell < std::min(cells.size(), first + kBlock); ++cell) {
      corners.clear();
      for (const std::uint32_t p : cells.corners(cell)) {
        corners.push_back(points[p]);
        own.push_back(p);
      }
      lanes_.add(corners);
    }
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    addBlock(own, points);
  }
  addBlock({}, points);
  addGroups();
}

void CellBlocks::addBlock(std::span<const std::uint32_t> own, std::span<const Point32> points) {
  Eigen::AlignedBox3f box;
  const auto firstPoint = static_cast<std::uint32_t>(points_[0].size());
  for (const std::uint32_t p : own) {
    box.extend(Eigen::Vector3f(points[p].x, points[p].y, points[p].z));
    points_[0].push_back(points[p].x);
    points_[1].push_back(points[p].y);
    points_[2].push_back(points[p].z);
  }
  Block block;
  block.firstPoint = firstPoint;
  if (!own.empty()) {
    const Eigen::Vector3f center = box.center();
    block.extent = {{center.x(), center.y(), center.z()}, box.diagonal().norm() / 2};
  }
  blocks_.push_back(block);
}

void CellBlocks::addGroups() {
  for (std::size_t first = 0; first + 1 < blocks_.size(); first += kGroup) {
    const std::size_t last = std::min(first + kGroup, blocks_.size() - 1);
    Eigen::AlignedBox3f box;
    for (std::size_t b = first; b < last; ++b) {
      const Extent& own = blocks_[b].extent;
      const Eigen::Vector3f middle(own.middle.x, own.middle.y, own.middle.z);
      box.extend(middle - Eigen::Vector3f::Constant(own.radius));
      box.extend(middle + Eigen::Vector3f::Constant(own.radius));
    }
    const Eigen::Vector3f center = box.center();
    groups_.push_back({{center.x(), center.y(), center.z()}, box.diagonal().norm() / 2});
  }
}

std::size_t CellBlocks::endOf(std::size_t block) const {
  return std::min(cells_.size(), (block + 1) * kBlock);
}

bool CellBlocks::holds(std::uint32_t ball, std::size_t block, float standOff) const {
  const float radius = depths_[ball] + standOff;
  if (radius < 0) return false;
  const float* x = points_[0].data();
  const float* y = points_[1].data();
  const float* z = points_[2].data();
  const Point32 c = centers_[ball];
  float farthest = 0;
  const std::uint32_t last = blocks_[block + 1].firstPoint;
#pragma omp simd reduction(max : farthest)
  for (std::uint32_t i = blocks_[block].firstPoint; i < last; ++i) {
    const float dx = x[i] - c.x;
    const float dy = y[i] - c.y;
    const float dz = z[i] - c.z;
    const float squared = dx * dx + dy * dy + dz * dz;
    farthest = squared > farthest ? squared : farthest;
  }
  return farthest <= radius * radius;
}

void CellBlocks::select(const Extent& extent, const std::vector<std::uint32_t>& from,
                        std::vector<std::uint32_t>& to) {
  float least = std::numeric_limits<float>::infinity();
  std::size_t best = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Point32& center = centers_[from[i]];
    const float dx = center.x - extent.middle.x;
    const float dy = center.y - extent.middle.y;
    const float dz = center.z - extent.middle.z;
    estimate_[i] = std::sqrt(dx * dx + dy * dy + dz * dz) - depths_[from[i]];
    if (estimate_[i] >= least) continue;
    least = estimate_[i];
    best = i;
  }
  to.assign(1, from[best]);
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (i != best && estimate_[i] <= least + 2 * extent.radius) to.push_back(from[i]);
  }
}

void CellBlocks::findNear(std::size_t index, float worst) {
  Block& block = blocks_[index];
  near_.clear();
  if (block.likely < all_.size() && holds(block.likely, index, worst)) return;
  if (index / kGroup != group_) {
    group_ = index / kGroup;
    select(groups_[group_], all_, nearGroup_);
  }
  select(block.extent, nearGroup_, near_);
  block.likely = near_.front();
  if (holds(block.likely, index, worst)) near_.clear();
}

void CellBlocks::prepare(std::span<const Candidate> balls) {
  centers_.clear();
  depths_.clear();
  all_.clear();
  for (const Candidate& ball : balls) {
    all_.push_back(static_cast<std::uint32_t>(all_.size()));
    centers_.push_back(toPoint32(ball.center - middle_));
    depths_.push_back(static_cast<float>(ball.depth));
  }
  group_ = groups_.size();
  estimate_.resize(balls.size());
}

CellBlocks::Check CellBlocks::check(std::span<const Candidate> balls, double atLeast, double limit) {
  prepare(balls);
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> worstCell(balls.size(), kNone);
  std::vector<float> worstOf(balls.size(), static_cast<float>(limit));
  std::vector<float> reaches;
  std::vector<float> least(kBlock);
  std::vector<std::uint32_t> owner(kBlock);
  auto worst = static_cast<float>(atLeast);
  for (std::size_t b = 0; b + 1 < blocks_.size(); ++b) {
    findNear(b, worst);
    if (near_.empty()) continue;
    const std::size_t first = b * kBlock;
    const std::size_t count = endOf(b) - first;
    std::fill(least.begin(), least.end(), std::numeric_limits<float>::infinity());
    for (const std::uint32_t ball : near_) {
      lanes_.farthestSquared(first, first + count, centers_[ball], reaches);
      for (std::size_t i = 0; i < count; ++i) {
        const float standOff = std::sqrt(reaches[i]) - depths_[ball];
        if (standOff < least[i]) {
          least[i] = standOff;
          owner[i] = ball;
        }
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      worst = std::max(worst, least[i]);
      if (least[i] <= worstOf[owner[i]]) continue;
      worstOf[owner[i]] = least[i];
      worstCell[owner[i]] = static_cast<std::uint32_t>(first + i);
    }
  }
  Check result{static_cast<double>(worst), {}};
  for (const std::uint32_t cell : worstCell) {
    if (cell != kNone) result.worse.push_back(cell);
  }
  return result;
}

double CellBlocks::standOff(std::span<const Candidate> balls) {
  prepare(balls);
  double worst = -std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b + 1 < blocks_.size(); ++b) {
    findNear(b, -std::numeric_limits<float>::infinity());
    for (std::size_t cell = b * kBlock; cell < endOf(b); ++cell) {
      double least = std::numeric_limits<double>::infinity();
      for (const std::uint32_t ball : near_) {
        const double reach = std::sqrt(cells_.farthestSquared(cell, balls[ball].center));
        least = std::min(least, reach - balls[ball].depth);
      }
      worst = std::max(worst, least);
    }
  }
  return worst;
}

}  // namespace spheretree::builders
