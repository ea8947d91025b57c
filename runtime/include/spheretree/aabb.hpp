// SPDX-License-Identifier: MIT
#pragma once

#include <spheretree/sphere.hpp>

namespace spheretree {

/// A closed axis-aligned box in world units. Well formed when min <= max on every axis.
struct Aabb {
  Vec3 min;
  Vec3 max;

  friend constexpr bool operator==(const Aabb&, const Aabb&) = default;
};

/// True when the two closed boxes share a point. Touching counts.
[[nodiscard]] constexpr bool overlap(const Aabb& a, const Aabb& b) noexcept {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
         a.min.z <= b.max.z && b.min.z <= a.max.z;
}

/// The smallest box around a ball, up to the rounding of the six subtractions and additions.
[[nodiscard]] constexpr Aabb boundsOf(const Sphere& ball) noexcept {
  const Vec3 r{ball.radius, ball.radius, ball.radius};
  return {ball.center - r, ball.center + r};
}

}  // namespace spheretree
