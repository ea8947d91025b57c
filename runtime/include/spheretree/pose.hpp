// SPDX-License-Identifier: MIT
#pragma once

#include <spheretree/sphere.hpp>

namespace spheretree {

/// A unit quaternion; (0, 0, 0, 1) is no rotation.
struct Rotation {
  float x = 0;
  float y = 0;
  float z = 0;
  float w = 1;
};

/// Where a body stands: scale first, then rotate, then translate. Scale is uniform and positive.
struct Pose {
  Rotation rotation;
  Vec3 translation;
  float scale = 1;
};

[[nodiscard]] constexpr Vec3 rotate(const Rotation& q, Vec3 v) noexcept {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2.0F * cross(u, v);
  return v + q.w * t + cross(u, t);
}

[[nodiscard]] constexpr Vec3 transform(const Pose& pose, Vec3 point) noexcept {
  return rotate(pose.rotation, pose.scale * point) + pose.translation;
}

[[nodiscard]] constexpr Sphere transform(const Pose& pose, const Sphere& ball) noexcept {
  return {transform(pose, ball.center), pose.scale * ball.radius};
}

}  // namespace spheretree
