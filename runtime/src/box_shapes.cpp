// SPDX-License-Identifier: MIT
//
// Boxes as shapes. Box against box by separating axes, after S. Gottschalk, M. C. Lin and D. Manocha,
// "OBBTree", SIGGRAPH 1996: three faces of each and nine pairs of edges. Box against ball by the nearest
// point of the box, eight balls at once (pair_walk.cpp).

#include "box_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pair_walk.hpp"
#include "relative_pose.hpp"

namespace spheretree::detail {

namespace {

float extentOf(Vec3 halfEdges) noexcept {
  return length(halfEdges) * (1 + 0x1p-21F);
}

Vec3 pick(Vec3 size, Vec3 direction) noexcept {
  // Along a face the whole face is farthest: its middle then stands for it.
  constexpr float kFlat = 1e-4F;
  const auto side = [](float edge, float along) {
    return along > kFlat ? edge : along < -kFlat ? -edge : 0.0F;
  };
  return {side(size.x, direction.x), side(size.y, direction.y), side(size.z, direction.z)};
}

struct Axes {
  std::array<Vec3, 3> a;  // of box A, in the frame of B, unit
};

Axes axesOf(const RelativePose& pose) noexcept {
  if (!pose.turned) return {{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}};
  const float perScale = 1 / pose.scale;
  const auto& m = pose.matrix;
  return {{perScale * Vec3{m[0], m[3], m[6]}, perScale * Vec3{m[1], m[4], m[7]},
           perScale * Vec3{m[2], m[5], m[8]}}};
}

/// How far a box reaches along a direction from its centre.
float reachOf(const Axes& axes, Vec3 half, Vec3 direction) noexcept {
  return half.x * std::abs(dot(axes.a[0], direction)) + half.y * std::abs(dot(axes.a[1], direction)) +
         half.z * std::abs(dot(axes.a[2], direction));
}

constexpr Axes kOwnAxes{{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}};

bool touches(Vec3 half, const Sphere& ball) noexcept {
  const Vec3 c = ball.center;
  const Vec3 out{std::max(0.0F, std::abs(c.x) - half.x), std::max(0.0F, std::abs(c.y) - half.y),
                 std::max(0.0F, std::abs(c.z) - half.z)};
  return !(dot(out, out) > ball.radius * ball.radius);
}

}  // namespace

bool touch(const PosedBox& a, const PosedBox& b, ShapeContact& contact) noexcept {
  const RelativePose pose = relativePose(a.pose, b.pose);
  const Vec3 halfA = pose.scale * a.halfEdges;
  const float margin = marginOf(pose, extentOf(a.halfEdges), extentOf(b.halfEdges));
  const Axes axes = axesOf(pose);
  float least = std::numeric_limits<float>::infinity();
  Vec3 normal{1, 0, 0};
  const auto separates = [&](Vec3 direction) {
    const float norm = length(direction);
    if (norm < 1e-3F) return false;  // parallel edges: the faces decide
    const Vec3 unit = (1 / norm) * direction;
    const float along = dot(pose.shift, unit);
    const float depth = reachOf(axes, halfA, unit) + reachOf(kOwnAxes, b.halfEdges, unit) - std::abs(along);
    if (depth < -margin / norm) return true;
    if (depth < least) {
      least = depth;
      normal = along > 0 ? -unit : unit;
    }
    return false;
  };
  for (const Vec3 axis : kOwnAxes.a) {
    if (separates(axis)) return false;
  }
  if (pose.turned) {
    for (const Vec3 axis : axes.a) {
      if (separates(axis)) return false;
    }
    for (const Vec3 x : axes.a) {
      for (const Vec3 y : kOwnAxes.a) {
        if (separates(cross(x, y))) return false;
      }
    }
  }
  const Vec3 inA{dot(axes.a[0], normal), dot(axes.a[1], normal), dot(axes.a[2], normal)};
  const Vec3 cornerA = pick(halfA, inA);
  const Vec3 farA = pose.shift + cornerA.x * axes.a[0] + cornerA.y * axes.a[1] + cornerA.z * axes.a[2];
  const Vec3 farB = pick(b.halfEdges, -normal);
  contact.point = transform(b.pose, 0.5F * (farA + farB));
  contact.normal = rotate(b.pose.rotation, normal);
  contact.depth = b.pose.scale * std::max(0.0F, least);
  contact.level = 0;
  return true;
}

bool touch(const PosedBox& box, const PosedTree& tree, std::uint32_t level, ShapeContact& contact) noexcept {
  const RelativePose pose = relativePose(tree.pose, box.pose);
  const Vec3 half = box.halfEdges;
  const float margin = marginOf(pose, tree.tree.extent(), extentOf(half));
  const auto lastLevel = std::min(level, static_cast<std::uint32_t>(tree.tree.levelCount() - 1));
  Sphere ball = place(pose, tree.tree.root(), margin);
  if (!touches(half, ball)) return false;
  if (lastLevel > 0) {
    BoxWalk walk;
    walk.half = half;
    walk.tree = &tree.tree;
    walk.level = lastLevel;
    setPlacement(walk.placement, pose, margin);
    if (!walkPaths(activeSimd()).box(walk)) return false;
    ball = walk.found;
  }
  ball.radius = std::max(0.0F, ball.radius - margin);
  const Vec3 c = ball.center;
  Vec3 nearest{std::clamp(c.x, -half.x, half.x), std::clamp(c.y, -half.y, half.y),
               std::clamp(c.z, -half.z, half.z)};
  const Vec3 out = c - nearest;
  const float distance = length(out);
  Vec3 normal{1, 0, 0};
  float depth = 0;
  if (distance > 0) {
    normal = (1 / distance) * out;
    depth = ball.radius - distance;
  } else {  // the centre is inside: out through the nearest face
    const Vec3 gap{half.x - std::abs(c.x), half.y - std::abs(c.y), half.z - std::abs(c.z)};
    const auto sign = [](float value) { return value < 0 ? -1.0F : 1.0F; };
    if (gap.x <= gap.y && gap.x <= gap.z) {
      normal = {sign(c.x), 0, 0};
      depth = ball.radius + gap.x;
    } else if (gap.y <= gap.z) {
      normal = {0, sign(c.y), 0};
      depth = ball.radius + gap.y;
    } else {
      normal = {0, 0, sign(c.z)};
      depth = ball.radius + gap.z;
    }
  }
  contact.point = transform(box.pose, nearest);
  contact.normal = rotate(box.pose.rotation, normal);
  contact.depth = box.pose.scale * std::max(0.0F, depth);
  contact.level = lastLevel;
  contact.rounding = 2 * box.pose.scale * margin;
  return true;
}

}  // namespace spheretree::detail
