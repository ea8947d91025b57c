// SPDX-License-Identifier: MIT
//
// The paper's combination: a regular grid, and Sweep & Prune within each voxel.
//
// One list of all bodies is kept in order along x by insertion sort; filing it voxel by voxel leaves every
// voxel's own list sorted. Within a voxel a box meets those that begin before it ends.

#include <spheretree/grid_sweep.hpp>

#include <algorithm>
#include <numeric>

#include "box_check.hpp"
#include "pair_sort.hpp"

namespace spheretree {

namespace {

constexpr std::size_t kMovesPerBody = 64;  // beyond which the list is better sorted anew

}  // namespace

void GridSweep::sortBodies(std::span<const Aabb> boxes) {
  const auto before = [&](std::uint32_t a, std::uint32_t b) { return boxes[a].min.x < boxes[b].min.x; };
  if (order_.size() != boxes.size()) {
    order_.resize(boxes.size());
    std::iota(order_.begin(), order_.end(), 0U);
    std::sort(order_.begin(), order_.end(), before);
    return;
  }
  std::size_t moves = 0;
  for (std::size_t i = 1; i < order_.size(); ++i) {
    const std::uint32_t body = order_[i];
    std::size_t j = i;
    for (; j > 0 && before(body, order_[j - 1]); --j) order_[j] = order_[j - 1];
    order_[j] = body;
    moves += i - j;
    if (moves > kMovesPerBody * order_.size()) return std::sort(order_.begin(), order_.end(), before);
  }
}

Result<Done> GridSweep::findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) {
  pairs.clear();
  if (boxes.size() > detail::kMaxBodies) return detail::tooManyBoxes();
  if (const std::size_t fault = detail::firstFault(boxes); fault != detail::kNoFault)
    return detail::faultAt(fault);
  sortBodies(boxes);
  voxels_.file(boxes, order_);
  for (std::size_t index = 0; index < voxels_.voxelCount(); ++index) {
    const std::span<const std::uint32_t> bodies = voxels_.voxel(index);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const std::uint32_t a = bodies[i];
      const float end = boxes[a].max.x;
      for (std::size_t j = i + 1; j < bodies.size() && boxes[bodies[j]].min.x <= end; ++j) {
        const std::uint32_t b = bodies[j];
        if (!overlap(boxes[a], boxes[b]) || voxels_.owner(a, b) != index) continue;
        pairs.push_back({std::min(a, b), std::max(a, b)});
      }
    }
  }
  detail::sortPairs(pairs, scratch_, boxes.size());
  return Done{};
}

}  // namespace spheretree
