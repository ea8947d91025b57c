// SPDX-License-Identifier: MIT
//
// The octree of the paper, rebuilt in every call and never stored: only the lists of bodies on the way down
// are.
//
// Boxes are known by the range of smallest cells they touch, so going down takes integer comparisons. A pair
// is delivered by the cell that holds the lower corner of both ranges' intersection.

#include <spheretree/octree_broad_phase.hpp>

#include <algorithm>

#include "box_check.hpp"
#include "pair_sort.hpp"

namespace spheretree {

namespace {

constexpr std::uint32_t kMostDepth = 10;
constexpr std::size_t kFewBodies = 8;  // testing 28 pairs costs about as much as handing eight bodies on

// A cell whose bodies touch more children than this, on average, gains nothing: eight lists of a quarter of
// the bodies have half the pairs.
constexpr std::size_t kMostHandedOn = 2;
constexpr double kLeastExtents = 2;  // an axis along which so few boxes find room is not cut

std::uint16_t cellOf(float value, double low, double perUnit, double last) noexcept {
  return static_cast<std::uint16_t>(std::clamp((static_cast<double>(value) - low) * perUnit, 0.0, last));
}

}  // namespace

OctreeBroadPhase::OctreeBroadPhase(std::uint32_t depth) noexcept : depth_(std::min(depth, kMostDepth)) {}

void OctreeBroadPhase::findRanges(std::span<const Aabb> boxes) {
  Aabb bounds = kAbsentBox;
  std::array<double, 3> extents{};
  bodies_.clear();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Aabb& box = boxes[i];
    if (detail::isAbsent(box)) continue;
    bodies_.push_back(static_cast<std::uint32_t>(i));
    bounds.min = {std::min(bounds.min.x, box.min.x), std::min(bounds.min.y, box.min.y),
                  std::min(bounds.min.z, box.min.z)};
    bounds.max = {std::max(bounds.max.x, box.max.x), std::max(bounds.max.y, box.max.y),
                  std::max(bounds.max.z, box.max.z)};
    extents[0] += static_cast<double>(box.max.x) - static_cast<double>(box.min.x);
    extents[1] += static_cast<double>(box.max.y) - static_cast<double>(box.min.y);
    extents[2] += static_cast<double>(box.max.z) - static_cast<double>(box.min.z);
  }
  const double cells = 1U << depth_;
  const auto perUnit = [&](float low, float high, double sumOfExtents) {
    const double length = static_cast<double>(high) - static_cast<double>(low);
    return length * static_cast<double>(bodies_.size()) > kLeastExtents * sumOfExtents ? cells / length : 0;
  };
  const std::array<double, 3> low{static_cast<double>(bounds.min.x), static_cast<double>(bounds.min.y),
                                  static_cast<double>(bounds.min.z)};
  const std::array<double, 3> scale{perUnit(bounds.min.x, bounds.max.x, extents[0]),
                                    perUnit(bounds.min.y, bounds.max.y, extents[1]),
                                    perUnit(bounds.min.z, bounds.max.z, extents[2])};
  if (ranges_.size() < boxes.size()) ranges_.resize(boxes.size());
  for (const std::uint32_t body : bodies_) {
    const auto cellsOf = [&](const Vec3& corner) -> std::array<std::uint16_t, 3> {
      return {cellOf(corner.x, low[0], scale[0], cells - 1), cellOf(corner.y, low[1], scale[1], cells - 1),
              cellOf(corner.z, low[2], scale[2], cells - 1)};
    };
    ranges_[body] = {cellsOf(boxes[body].min), cellsOf(boxes[body].max)};
  }
}

void OctreeBroadPhase::testAll(std::span<const Aabb> boxes, const Cell& cell,
                               std::vector<BodyPair>& pairs) const {
  const auto owns = [&](const Range& a, const Range& b) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Both touch the cell, so the corner is not beyond it; it may lie before it.
      if (std::max(a.first[k], b.first[k]) < cell.corner[k]) {
        return false;
      }
    }
    return true;
  };
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    const std::uint32_t a = bodies_[i];
    for (std::size_t j = i + 1; j < cell.end; ++j) {
      const std::uint32_t b = bodies_[j];
      if (overlap(boxes[a], boxes[b]) && owns(ranges_[a], ranges_[b])) pairs.push_back({a, b});
    }
  }
}

/// Large boxes touch all children: handing them on would only multiply the tests.
bool OctreeBroadPhase::worthSplitting(const Cell& cell) const noexcept {
  const std::uint32_t half = cell.edge / 2;
  std::size_t handed = 0;
  for (std::size_t i = cell.begin; i < cell.end; ++i) {
    const Range& range = ranges_[bodies_[i]];
    std::size_t children = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t middle = cell.corner[k] + half;
      children *= range.first[k] < middle && range.last[k] >= middle ? std::size_t{2} : 1;
    }
    handed += children;
  }
  return handed <= kMostHandedOn * (cell.end - cell.begin);
}

void OctreeBroadPhase::visit(std::span<const Aabb> boxes, const Cell& cell, std::vector<BodyPair>& pairs) {
  if (cell.end - cell.begin < 2) return;
  if (cell.edge == 1 || cell.end - cell.begin <= kFewBodies || !worthSplitting(cell)) {
    return testAll(boxes, cell, pairs);
  }
  const std::uint32_t half = cell.edge / 2;
  for (std::uint32_t child = 0; child < 8; ++child) {
    Cell inner{cell.corner, half, cell.end, cell.end};
    for (std::uint32_t k = 0; k < 3; ++k) inner.corner[k] += (child >> k & 1U) * half;
    for (std::size_t i = cell.begin; i < cell.end; ++i) {
      const std::uint32_t body = bodies_[i];
      const Range& range = ranges_[body];
      bool touches = true;
      for (std::size_t k = 0; k < 3; ++k) {
        touches &= range.first[k] < inner.corner[k] + half && range.last[k] >= inner.corner[k];
      }
      if (touches) bodies_.push_back(body);
    }
    inner.end = bodies_.size();
    visit(boxes, inner, pairs);
    bodies_.resize(cell.end);
  }
}

Result<Done> OctreeBroadPhase::findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) {
  pairs.clear();
  if (boxes.size() > detail::kMaxBodies) return detail::tooManyBoxes();
  if (const std::size_t fault = detail::firstFault(boxes); fault != detail::kNoFault)
    return detail::faultAt(fault);
  findRanges(boxes);
  visit(boxes, {{0, 0, 0}, 1U << depth_, 0, bodies_.size()}, pairs);
  detail::sortPairs(pairs, scratch_, boxes.size());
  return Done{};
}

}  // namespace spheretree
