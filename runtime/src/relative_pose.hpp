// SPDX-License-Identifier: MIT
#pragma once

// Queries work in the frame of B, in single precision with a margin. With u = 2^-24, the extents e of
// the trees, the scale s of A in B and the shift t: the quaternion of the relative rotation errs by 8 u, so
// the rotation by 16 u; the matrix made of it by 18 u in the Frobenius norm; applying it by 9 u; the shift,
// turned into the frame of B, by 25 u of itself. A placed centre is therefore off by at most 43 u s e_A + 27
// u |t|, the difference of two centres by u of its length, the squared length by 4 u of itself, the radii and
// their sum by 3 u. All that is below 50 u (s e_A + |t| + e_B); the margin is 128 u of it.

#include <cmath>
#include <limits>

#include <spheretree/pair_query.hpp>
#include <spheretree/pose.hpp>
#include <spheretree/sphere.hpp>

namespace spheretree::detail {

inline constexpr float kMarginPerLength = 0x1p-17F;
/// Squares of lengths below this lose digits to underflow.
inline constexpr float kShortestLength = 0x1p-60F;
/// Squares of lengths above this come close to overflow.
inline constexpr float kLongestLength = 1e17F;

/// A as B sees it.
[[nodiscard]] RelativePose relativePose(const Pose& a, const Pose& b) noexcept;

inline Vec3 place(const RelativePose& pose, Vec3 p) noexcept {
  if (!pose.turned) return p + pose.shift;
  const auto& m = pose.matrix;
  return Vec3{m[0] * p.x + m[1] * p.y + m[2] * p.z, m[3] * p.x + m[4] * p.y + m[5] * p.z,
              m[6] * p.x + m[7] * p.y + m[8] * p.z} +
         pose.shift;
}

inline Sphere place(const RelativePose& pose, const Sphere& ball, float margin) noexcept {
  return {place(pose, ball.center), pose.scale * ball.radius + margin};
}

/// The matrix is left alone when it is not needed: writing it takes as long as testing eight balls.
inline void setPlacement(BallPlacement& placement, const RelativePose& pose, float margin) noexcept {
  if (pose.turned) placement.pose.matrix = pose.matrix;
  placement.pose.shift = pose.shift;
  placement.pose.scale = pose.scale;
  placement.pose.turned = pose.turned;
  placement.margin = margin;
}

/// More than all rounding of a test between balls of A, placed in the frame of B, and balls of B, given how
/// far from their origins they reach. Infinite when there are lengths that squares of floats cannot hold.
inline float marginOf(const RelativePose& pose, float extentA, float extentB) noexcept {
  const float size = pose.scale * extentA + extentB +
                     (std::abs(pose.shift.x) + std::abs(pose.shift.y) + std::abs(pose.shift.z));
  return size < kLongestLength ? size * kMarginPerLength + kShortestLength
                               : std::numeric_limits<float>::infinity();
}

}  // namespace spheretree::detail
