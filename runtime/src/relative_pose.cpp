// SPDX-License-Identifier: MIT

#include "relative_pose.hpp"

#include <array>

namespace spheretree::detail {

namespace {

bool isIdentity(const Rotation& q) noexcept {
  return q.x == 0 && q.y == 0 && q.z == 0;
}

bool same(const Rotation& a, const Rotation& b) noexcept {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
}

float squaredNorm(const Rotation& q) noexcept {
  return (q.x * q.x + q.y * q.y) + (q.z * q.z + q.w * q.w);
}

/// conj(b) a: the rotation of A as B sees it, as long as a and b make it.
Rotation relativeRotation(const Rotation& a, const Rotation& b) noexcept {
  return {
      (b.w * a.x - b.x * a.w) + (b.z * a.y - b.y * a.z), (b.w * a.y - b.y * a.w) + (b.x * a.z - b.z * a.x),
      (b.w * a.z - b.z * a.w) + (b.y * a.x - b.x * a.y), (b.w * a.w + b.x * a.x) + (b.y * a.y + b.z * a.z)};
}

std::array<float, 9> matrixOf(const Rotation& q, float scale) noexcept {
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
Vec3 turnBack(const Rotation& q, Vec3 v) noexcept {
  const float k = 2 / squaredNorm(q);
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 c = cross(v, u);
  return v + k * (q.w * c + cross(c, u));
}

}  // namespace

RelativePose relativePose(const Pose& a, const Pose& b) noexcept {
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

}  // namespace spheretree::detail
