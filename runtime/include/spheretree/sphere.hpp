// SPDX-License-Identifier: MIT
#pragma once

#include <spheretree/vec3.hpp>

namespace spheretree {

/// A closed ball in mesh units: every point at most `radius` away from `center` belongs to it.
struct Sphere {
  Vec3 center;
  float radius = 0;

  friend constexpr bool operator==(const Sphere&, const Sphere&) = default;
};

/// True when the two closed balls share a point. Touching counts.
[[nodiscard]] constexpr bool overlap(const Sphere& a, const Sphere& b) noexcept {
  const Vec3 d = b.center - a.center;
  const float reach = a.radius + b.radius;
  return dot(d, d) <= reach * reach;
}

}  // namespace spheretree
