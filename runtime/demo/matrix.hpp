// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <spheretree/vec3.hpp>

namespace crowded_room {

/// A direction of length 1. The null vector stays what it is.
[[nodiscard]] inline spheretree::Vec3 unit(spheretree::Vec3 v) noexcept {
  const float size = length(v);
  return size > 0 ? (1 / size) * v : v;
}

/// A 4 x 4 matrix, column by column as OpenGL wants it.
struct Matrix {
  std::array<float, 16> m{};

  [[nodiscard]] float at(std::size_t row, std::size_t column) const noexcept { return m[4 * column + row]; }
};

[[nodiscard]] inline Matrix operator*(const Matrix& a, const Matrix& b) noexcept {
  Matrix product;
  for (std::size_t column = 0; column < 4; ++column) {
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t k = 0; k < 4; ++k)
        product.m[4 * column + row] += a.m[4 * k + row] * b.m[4 * column + k];
    }
  }
  return product;
}

/// World to eye coordinates: the eye looks along -z, y is up.
[[nodiscard]] inline Matrix lookAt(spheretree::Vec3 eye, spheretree::Vec3 target,
                                   spheretree::Vec3 up) noexcept {
  const spheretree::Vec3 back = unit(eye - target);
  const spheretree::Vec3 right = unit(cross(up, back));
  const spheretree::Vec3 top = cross(back, right);
  return {{right.x, top.x, back.x, 0, right.y, top.y, back.y, 0, right.z, top.z, back.z, 0, -dot(right, eye),
           -dot(top, eye), -dot(back, eye), 1}};
}

/// Depths to draw between, both positive.
struct DepthRange {
  float near = 0.1F;
  float far = 1000;
};

/// `slope` is the tangent of half the vertical field of view, `aspect` width over height.
[[nodiscard]] inline Matrix perspective(float slope, float aspect, DepthRange range) noexcept {
  Matrix p;
  p.m[0] = 1 / (slope * aspect);
  p.m[5] = 1 / slope;
  p.m[10] = (range.far + range.near) / (range.near - range.far);
  p.m[11] = -1;
  p.m[14] = 2 * range.far * range.near / (range.near - range.far);
  return p;
}

/// A box in eye coordinates, given by its corners, to the cube that is drawn.
[[nodiscard]] inline Matrix orthographic(spheretree::Vec3 low, spheretree::Vec3 high) noexcept {
  Matrix p;
  p.m[0] = 2 / (high.x - low.x);
  p.m[5] = 2 / (high.y - low.y);
  p.m[10] = -2 / (high.z - low.z);
  p.m[12] = -(high.x + low.x) / (high.x - low.x);
  p.m[13] = -(high.y + low.y) / (high.y - low.y);
  p.m[14] = (high.z + low.z) / (high.z - low.z);
  p.m[15] = 1;
  return p;
}

[[nodiscard]] inline spheretree::Vec3 transformPoint(const Matrix& a, spheretree::Vec3 p) noexcept {
  return {a.m[0] * p.x + a.m[4] * p.y + a.m[8] * p.z + a.m[12],
          a.m[1] * p.x + a.m[5] * p.y + a.m[9] * p.z + a.m[13],
          a.m[2] * p.x + a.m[6] * p.y + a.m[10] * p.z + a.m[14]};
}

}  // namespace crowded_room
