// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <spheretree/broad_phase.hpp>

namespace spheretree {

/// An octree over the bounds of all boxes, built in every call: a cell with few boxes, or at the greatest
/// depth, tests them all; another one hands them on to those of its eight children that they touch.
///
/// O(n depth + pairs) for small boxes. Unlike Grid it does not mind empty space.
class OctreeBroadPhase final : public BroadPhase {
 public:
  /// Halvings of the bounds along each axis, at most 10; the paper's is 3.
  explicit OctreeBroadPhase(std::uint32_t depth = 3) noexcept;

  Result<Done> findPairs(std::span<const Aabb> boxes, std::vector<BodyPair>& pairs) override;

 private:
  /// The smallest cells that a box touches.
  struct Range {
    std::array<std::uint16_t, 3> first;
    std::array<std::uint16_t, 3> last;
  };
  /// A cell and the run of bodies_ that touch it.
  struct Cell {
    std::array<std::uint32_t, 3> corner;
    std::uint32_t edge;
    std::size_t begin;
    std::size_t end;
  };

  void findRanges(std::span<const Aabb> boxes);
  [[nodiscard]] bool worthSplitting(const Cell& cell) const noexcept;
  void visit(std::span<const Aabb> boxes, const Cell& cell, std::vector<BodyPair>& pairs);
  void testAll(std::span<const Aabb> boxes, const Cell& cell, std::vector<BodyPair>& pairs) const;

  std::uint32_t depth_;
  std::vector<Range> ranges_;
  std::vector<std::uint32_t> bodies_;  // of the cells on the way down
  std::vector<BodyPair> scratch_;
};

}  // namespace spheretree
