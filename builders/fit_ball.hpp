// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "medial/surface.hpp"

namespace spheretree::builders {

/// The depth of a place and how it changes there.
struct DepthProbe {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double depth = 0;                                    ///< mesh units, negative outside
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  ///< unit length, points away from the nearest surface
};

/// Depth and gradient at a point, one closest-point query. `known` saves the inside test when `at` lies
/// within the ball around it that the surface cannot cross.
[[nodiscard]] DepthProbe probeDepth(const medial::Surface& surface, const Eigen::Vector3d& at,
                                    const DepthProbe* known = nullptr);

/// Points as a structure of arrays.
struct PointBlock {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> z;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  [[nodiscard]] Eigen::Vector3d at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void clear();
  void push(const Eigen::Vector3d& p);
  void append(const PointBlock& more);
};

/// Largest squared distance from `center` to the points; 0 when there are none.
[[nodiscard]] double farthestSquared(const PointBlock& points, const Eigen::Vector3d& center);

/// Squared distances from `center`, one per point.
void squaredDistances(const PointBlock& points, const Eigen::Vector3d& center, std::vector<double>& squared);

/// A ball around points: reach is its radius, reach - depth its stand-off.
struct Fit {
  DepthProbe center;
  double reach = 0;

  [[nodiscard]] double standOff() const noexcept { return reach - center.depth; }
};

struct FitEffort {
  std::size_t queries = 8;  ///< most closest-point queries
  double tolerance = 1e-3;  ///< stop when less than this fraction of the stand-off is to be gained
};

/// Moves a centre to where the ball around `points` needs the least stand-off: a local minimum of
/// max |p - c| - depth(c). Never worse than the start. The far side is exact, the depth is modelled from
/// below and above by what the queries have shown so far (a proximal bundle method: C. Lemarechal 1978, K.
/// Kiwiel 1990): inside a convex solid the model is a bound, elsewhere pieces that prove wrong are dropped.
[[nodiscard]] Fit fitBall(const medial::Surface& surface, const PointBlock& points, const DepthProbe& start,
                          const FitEffort& effort);

}  // namespace spheretree::builders
