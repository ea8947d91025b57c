// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include <spheretree/pose.hpp>
#include <spheretree/query_tree.hpp>

namespace spheretree::detail {

/// A box around the origin of its pose; half edges before scaling.
struct PosedBox {
  Vec3 halfEdges;
  Pose pose;
};

struct PosedTree {
  const QueryTree& tree;
  const Pose& pose;
};

/// Where two shapes touch, world coordinates; the normal points from the first to the second.
struct ShapeContact {
  Vec3 point;
  Vec3 normal;
  float depth = 0;
  std::uint32_t level = 0;
  float rounding = 0;  // what rounding and the margin add to a slack; of a box and a tree
};

/// Whether two closed boxes share a point; never misses one.
[[nodiscard]] bool touch(const PosedBox& a, const PosedBox& b, ShapeContact& contact) noexcept;

/// Whether a closed box and a chain of balls down to `level` do; never misses. The box counts as solid.
[[nodiscard]] bool touch(const PosedBox& box, const PosedTree& tree, std::uint32_t level,
                         ShapeContact& contact) noexcept;

}  // namespace spheretree::detail
