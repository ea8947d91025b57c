// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace spheretree::medial {

/// A triangle along and across its longest edge. What the direction across is off by matters over the
/// triangle's width only, so places in it are right to a few roundings of its length, however thin it is;
/// the plain cross product and barycentric coordinates lose as many digits as the triangle is thin.
struct TriangleFrame {
  std::size_t first = 0;   ///< the corner where the longest edge begins
  Eigen::Vector3d along;   ///< unit, of the longest edge
  double length = 0;       ///< of the longest edge
  Eigen::Vector3d across;  ///< unit, towards the third corner; zero when the triangle has no width
  double apex = 0;         ///< place of the third corner along the longest edge
  double width = 0;        ///< and across it

  explicit TriangleFrame(const std::array<Eigen::Vector3d, 3>& corner) {
    std::array<double, 3> squared{};
    for (std::size_t k = 0; k < 3; ++k) squared[k] = (corner[(k + 1) % 3] - corner[k]).squaredNorm();
    if (squared[1] > squared[first]) first = 1;
    if (squared[2] > squared[first]) first = 2;
    const Eigen::Vector3d edge = corner[(first + 1) % 3] - corner[first];
    const Eigen::Vector3d side = corner[(first + 2) % 3] - corner[first];
    length = edge.norm();
    along = length > 0 ? Eigen::Vector3d(edge / length) : Eigen::Vector3d::Zero();
    apex = side.dot(along);
    across = side - apex * along;
    across -= across.dot(along) * along;  // the first time leaves a rounding of the length
    width = across.norm();
    across = width > 0 ? Eigen::Vector3d(across / width) : Eigen::Vector3d::Zero();
  }

  /// Unit, to the side from which the corners are seen counter-clockwise.
  [[nodiscard]] Eigen::Vector3d normal() const { return along.cross(across); }
};

}  // namespace spheretree::medial
