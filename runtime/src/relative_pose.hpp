// SPDX-License-Identifier: MIT
#pragma once

// Queries work in the frame of B, in single precision with a margin. With u = 2^-24, the extents e of
// the trees, the scale s of A in B and the shift t: the quaternion of the relative rotation errs by 8 u, so
// the rotation by 16 u; the matrix made of it by 18 u in the Frobenius norm; applying it by 9 u; the shift,
// turned into the frame of B, by 25 u of itself. A placed centre is therefore off by at most 43 u s e_A + 27
// u |t|, the difference of two centres by u of its length, the squared length by 4 u of itself, the radii and
// their sum by 3 u. All that is below 50 u (s e_A + |t| + e_B); the margin is 128 u of it.

#include <array>
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

inline bool isIdentity(const Rotation& q) noexcept {
  return q.x == 0 && q.y == 0 && q.z == 0;
}

inline bool same(const Rotation& a, const Rotation& b) noexcept {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
}

inline float squaredNorm(const Rotation& q) noexcept {
  return (q.x * q.x + q.y * q.y) + (q.z * q.z + q.w * q.w);
}

/// conj(b) a: the rotation of A as B sees it, as long as a and b make it.
inline Rotation relativeRotation(const Rotation& a, const Rotation& b) noexcept {
  return {
      (b.w * a.x - b.x * a.w) + (b.z * a.y - b.y * a.z), (b.w * a.y - b.y * a.w) + (b.x * a.z - b.z * a.x),
      (b.w * a.z - b.z * a.w) + (b.y * a.x - b.x * a.y), (b.w * a.w + b.x * a.x) + (b.y * a.y + b.z * a.z)};
}

inline std::array<float, 9> matrixOf(const Rotation& q, float scale) noexcept {
  const float k = 2 * scale / squaredNorm(q);
  const float x = k * q.x;
  const float y = k * q.y;
  const float z = k * q.z;
  const float xx = x * q.x, yy = y * q.y, zz = z * q.z;
  const float xy = x * q.y, xz = x * q.z, yz = y * q.z;
  const float wx = x * q.w, wy = y * q.w, wz = z * q.w;
  return {scale - (yy + zz), xy - wz, xz + wy, xy + wz,          scale - (xx + zz),
          yz - wx,           xz - wy, yz + wx, scale - (xx + yy)};
}

/// The vector turned back by q, whatever its length.
inline Vec3 turnBack(const Rotation& q, Vec3 v) noexcept {
  const float k = 2 / squaredNorm(q);
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 c = cross(v, u);
  return v + k * (q.w * c + cross(c, u));
}

inline RelativePose relativePose(const Pose& a, const Pose& b) noexcept {
  RelativePose pose;
  pose.shift = a.translation - b.translation;
  const bool straightB = isIdentity(b.rotation);
  const bool parallel = (straightB && isIdentity(a.rotation)) || same(a.rotation, b.rotation);
  const bool scaled = a.scale != 1 || b.scale != 1;
  if (!straightB) pose.shift = turnBack(b.rotation, pose.shift);
  if (scaled) {
    pose.scale = a.scale / b.scale;
    pose.shift = (1 / b.scale) * pose.shift;
  }
  pose.turned = !parallel || pose.scale != 1;
  if (pose.turned)
    pose.matrix = matrixOf(parallel ? Rotation{} : relativeRotation(a.rotation, b.rotation), pose.scale);
  return pose;
}

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
