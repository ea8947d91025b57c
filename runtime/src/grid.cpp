// SPDX-License-Identifier: MIT
//
// The regular grid of the paper: every box is filed under every voxel it touches, and only touched voxels are
// looked into.
//
// Counting sort instead of lists: count the boxes of each voxel, sum, place. A pair that shares several
// voxels is delivered by the one that holds the lower corner of the intersection of both boxes' voxel ranges,
// so no pair comes twice and none has to be looked up.

#include <spheretree/grid.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "box_check.hpp"
#include "pair_sort.hpp"

namespace spheretree {

namespace detail {

namespace {

constexpr std::uint32_t kMostPerAxis = 1024;
constexpr double kMostVoxels = 1 << 22U;
constexpr double kVoxelsPerBox = 1;      // more voxels than boxes cost more to clear than they save
constexpr double kVoxelPerExtent = 1.5;  // an edge shorter than the boxes files them under too many voxels
constexpr std::size_t kMostEntriesPerBox = 16;
constexpr std::size_t kLeastEntries = 1024;

struct Span {
  double low;
  double perUnit;  // voxels
  double last;     // voxel
};

std::uint16_t voxelOf(float value, const Span& span) noexcept {
  return static_cast<std::uint16_t>(
      std::clamp((static_cast<double>(value) - span.low) * span.perUnit, 0.0, span.last));
}

Span spanOf(float low, float high, std::uint32_t voxels) noexcept {
  const double length = static_cast<double>(high) - static_cast<double>(low);
  return {static_cast<double>(low), length > 0 ? voxels / length : 0, voxels - 1.0};
}

void include(Aabb& bounds, const Aabb& box) noexcept {
  bounds.min = {std::min(bounds.min.x, box.min.x), std::min(bounds.min.y, box.min.y),
                std::min(bounds.min.z, box.min.z)};
  bounds.max = {std::max(bounds.max.x, box.max.x), std::max(bounds.max.y, box.max.y),
                std::max(bounds.max.z, box.max.z)};
}

}  // namespace

/// As many voxels as boxes, nearly cubes, and none much shorter than the boxes.
void VoxelFile::chooseVoxels(std::size_t present, const Aabb& bounds,
                             const std::array<double, 3>& meanExtent) noexcept {
  if (given_.x != 0 && given_.y != 0 && given_.z != 0) {
    voxels_ = {std::min(given_.x, kMostPerAxis), std::min(given_.y, kMostPerAxis),
               std::min(given_.z, kMostPerAxis)};
    return;
  }
  const std::array<double, 3> room{static_cast<double>(bounds.max.x) - static_cast<double>(bounds.min.x),
                                   static_cast<double>(bounds.max.y) - static_cast<double>(bounds.min.y),
                                   static_cast<double>(bounds.max.z) - static_cast<double>(bounds.min.z)};
  std::array<double, 3> most;  // along each axis
  for (std::size_t k = 0; k < 3; ++k) {
    most[k] = meanExtent[k] > 0 ? room[k] / (kVoxelPerExtent * meanExtent[k])
              : room[k] > 0     ? kMostPerAxis
                                : 1.0;
    most[k] = std::clamp(most[k], 1.0, static_cast<double>(kMostPerAxis));
  }
  const double wanted = std::min(kVoxelsPerBox * static_cast<double>(present), kMostVoxels);
  const double product = most[0] * most[1] * most[2];
  const double shrink = product > wanted ? std::cbrt(wanted / product) : 1;
  for (std::size_t k = 0; k < 3; ++k)
    voxels_[k] = static_cast<std::uint32_t>(std::max(1.0, most[k] * shrink));
}

std::size_t VoxelFile::indexOf(std::size_t x, std::size_t y, std::size_t z) const noexcept {
  return (z * voxels_[1] + y) * voxels_[0] + x;
}

std::size_t VoxelFile::owner(std::uint32_t a, std::uint32_t b) const noexcept {
  const auto& first = ranges_[a].first;
  const auto& other = ranges_[b].first;
  return indexOf(std::max(first[0], other[0]), std::max(first[1], other[1]), std::max(first[2], other[2]));
}

/// Returns the number of entries that the boxes make.
std::size_t VoxelFile::findRanges(std::span<const Aabb> boxes, const Aabb& bounds) {
  const Span x = spanOf(bounds.min.x, bounds.max.x, voxels_[0]);
  const Span y = spanOf(bounds.min.y, bounds.max.y, voxels_[1]);
  const Span z = spanOf(bounds.min.z, bounds.max.z, voxels_[2]);
  if (ranges_.size() < boxes.size()) ranges_.resize(boxes.size());
  std::size_t entries = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Aabb& box = boxes[i];
    Range& range = ranges_[i];
    if (isAbsent(box)) {
      range = {{1, 1, 1}, {0, 0, 0}};  // no voxel
      continue;
    }
    range.first = {voxelOf(box.min.x, x), voxelOf(box.min.y, y), voxelOf(box.min.z, z)};
    range.last = {voxelOf(box.max.x, x), voxelOf(box.max.y, y), voxelOf(box.max.z, z)};
    std::size_t touched = 1;
    for (std::size_t k = 0; k < 3; ++k)
      touched *= static_cast<std::size_t>(range.last[k] - range.first[k]) + 1;
    entries += touched;
  }
  return entries;
}

template <class Visit>
void VoxelFile::forEachVoxel(const Range& range, Visit visit) const {
  for (std::size_t z = range.first[2]; z <= range.last[2]; ++z) {
    for (std::size_t y = range.first[1]; y <= range.last[1]; ++y) {
      const std::size_t row = indexOf(0, y, z);
      for (std::size_t x = range.first[0]; x <= range.last[0]; ++x) visit(row + x);
    }
  }
}

void VoxelFile::file(std::span<const Aabb> boxes, std::span<const std::uint32_t> order) {
  Aabb bounds = kAbsentBox;
  std::array<double, 3> extent{};
  std::size_t present = 0;
  for (const Aabb& box : boxes) {
    if (isAbsent(box)) continue;
    include(bounds, box);
    extent[0] += static_cast<double>(box.max.x) - static_cast<double>(box.min.x);
    extent[1] += static_cast<double>(box.max.y) - static_cast<double>(box.min.y);
    extent[2] += static_cast<double>(box.max.z) - static_cast<double>(box.min.z);
    ++present;
  }
  if (present == 0) bounds = {};
  for (double& e : extent) e /= static_cast<double>(std::max<std::size_t>(present, 1));
  chooseVoxels(present, bounds, extent);
  const std::size_t most = kMostEntriesPerBox * present + kLeastEntries;
  while (findRanges(boxes, bounds) > most && voxels_[0] * voxels_[1] * voxels_[2] > 1) {
    for (std::uint32_t& voxels : voxels_) voxels = (voxels + 1) / 2;  // large boxes among small ones: coarser
  }

  begins_.assign(std::size_t{voxels_[0]} * voxels_[1] * voxels_[2] + 1, 0);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    forEachVoxel(ranges_[i], [&](std::size_t voxel) { ++begins_[voxel]; });
  }
  std::inclusive_scan(begins_.begin(), begins_.end(), begins_.begin());
  if (bodies_.size() < begins_.back()) bodies_.resize(begins_.back());
  for (auto body = order.rbegin(); body != order.rend();
       ++body) {  // from ends to begins, so from last to first
    forEachVoxel(ranges_[*body], [&](std::size_t voxel) { bodies_[--begins_[voxel]] = *body; });
  }
}

}  // namespace detail

Result<Done> Grid::findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) {
  pairs.clear();
  if (boxes.size() > detail::kMaxBodies) return detail::tooManyBoxes();
  if (const std::size_t fault = detail::firstFault(boxes); fault != detail::kNoFault)
    return detail::faultAt(fault);
  if (order_.size() != boxes.size()) {
    order_.resize(boxes.size());
    std::iota(order_.begin(), order_.end(), 0U);
  }
  voxels_.file(boxes, order_);
  for (std::size_t index = 0; index < voxels_.voxelCount(); ++index) {
    const std::span<const std::uint32_t> bodies = voxels_.voxel(index);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const std::uint32_t a = bodies[i];
      for (const std::uint32_t b : bodies.subspan(i + 1)) {
        if (overlap(boxes[a], boxes[b]) && voxels_.owner(a, b) == index) pairs.push_back({a, b});
      }
    }
  }
  detail::sortPairs(pairs, scratch_, boxes.size());
  return Done{};
}

}  // namespace spheretree
