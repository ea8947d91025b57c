// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "medial/ball.hpp"
#include "medial/surface.hpp"

namespace spheretree::medial {

/// A point of the surface and the triangle it lies on.
struct SurfaceSample {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  std::uint32_t triangle = 0;
};

/// About `count` points spread over the surface: every used vertex when there are no more than `count`, the
/// rest evenly by area along a space-filling order of the triangles. Deterministic.
[[nodiscard]] std::vector<SurfaceSample> sampleSurface(const Surface& surface, std::uint32_t count);

/// The largest ball inside the solid that touches the surface at the sample (Ma, Bae, Choi, "3D medial axis
/// point approximation using nearest neighbors and the normal field", 2012), by exact closest points. It
/// works however thin the solid is. The radius is the depth of the centre, possibly 0.
[[nodiscard]] Ball tangentBall(const Surface& surface, const SurfaceSample& sample);

}  // namespace spheretree::medial
