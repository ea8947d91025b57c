// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <vector>

#include <spheretree/pose.hpp>
#include <spheretree/query_tree.hpp>

namespace spheretree::test {

/// A random number generator that is the same everywhere.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  float uniform(float low, float high) {
    return low + (high - low) * (static_cast<float>(engine_() >> 8U) * 0x1p-24F);
  }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(engine_()) % count; }
  Vec3 point(float reach) {
    const float x = uniform(-reach, reach);
    const float y = uniform(-reach, reach);
    return {x, y, uniform(-reach, reach)};
  }
  Rotation rotation() {
    for (;;) {
      const Vec3 u = point(1);
      const float w = uniform(-1, 1);
      const float norm = std::sqrt(dot(u, u) + w * w);
      if (norm > 0.1F && norm <= 1) return {u.x / norm, u.y / norm, u.z / norm, w / norm};
    }
  }
  Pose pose(float reach) {
    const Rotation turned = rotation();
    const Vec3 place = point(reach);
    return {turned, place, 1};
  }

 private:
  std::mt19937 engine_;
};

inline SphereTree treeOf(std::initializer_list<SphereTree::Entry> entries) {
  return SphereTree::create(std::vector<SphereTree::Entry>(entries)).value();
}

inline QueryTree queryTreeOf(const SphereTree& tree, std::span<const float> standOff = {}) {
  Result<QueryTree> made = QueryTree::create(tree, standOff);
  return std::move(made).value();
}

/// Balls that shrink by `shrink` from level to level around places inside their parents, between one and
/// `branch` children a node; one node in `leafShare` ends early.
inline SphereTree randomTree(Random& random, std::uint32_t levels, std::uint32_t branch,
                             std::uint32_t leafShare, float shrink = 0.55F) {
  std::vector<SphereTree::Entry> entries{{{random.point(0.2F), 1}, kNoParent}};
  std::size_t begin = 0;
  for (std::uint32_t level = 1; level < levels; ++level) {
    const std::size_t end = entries.size();
    for (std::size_t parent = begin; parent < end; ++parent) {
      if (parent > begin && random.below(leafShare) == 0) continue;
      const Sphere ball = entries[parent].ball;
      for (std::uint32_t k = 1 + random.below(branch); k > 0; --k) {
        const Vec3 center = ball.center + random.point(ball.radius * 0.7F);
        entries.push_back({{center, ball.radius * shrink}, static_cast<std::uint32_t>(parent)});
      }
    }
    begin = end;
  }
  return SphereTree::create(entries).value();
}

/// A complete tree of eight children a node, in cubes: what builders make of a box, roughly.
inline SphereTree latticeTree(std::uint32_t levels) {
  std::vector<SphereTree::Entry> entries{{{{0, 0, 0}, 1}, kNoParent}};
  std::size_t begin = 0;
  for (std::uint32_t level = 1; level < levels; ++level) {
    const std::size_t end = entries.size();
    for (std::size_t parent = begin; parent < end; ++parent) {
      const Sphere ball = entries[parent].ball;
      const float step = ball.radius / (2 * std::sqrt(3.0F));
      for (int k = 0; k < 8; ++k) {
        const Vec3 offset{(k & 1) != 0 ? step : -step, (k & 2) != 0 ? step : -step,
                          (k & 4) != 0 ? step : -step};
        entries.push_back({{ball.center + offset, ball.radius / 2}, static_cast<std::uint32_t>(parent)});
      }
    }
    begin = end;
  }
  return SphereTree::create(entries).value();
}

}  // namespace spheretree::test
