// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/finalize.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace spheretree::builders {
namespace {

// Fractions of a ball's own radius and of the root's. Far above what double arithmetic loses on the way from
// the builder's frame to the mesh's, far below any error that a tree is made for.
constexpr double kOwnSlack = 1e-6;
constexpr double kRootSlack = 1e-10;

/// The nearest float. The detour through memory is load-bearing: g++ 12 at -O2 vectorises a conversion to
/// float and back into nothing at all, and the rounding distance below would come out as 0.
float nearestFloat(double value) {
  volatile float rounded = static_cast<float>(value);
  return rounded;
}

}  // namespace

Sphere toSphere(const medial::Ball& ball) {
  Sphere sphere;
  sphere.center = {nearestFloat(ball.center.x()), nearestFloat(ball.center.y()),
                   nearestFloat(ball.center.z())};
  const Eigen::Vector3d rounded(static_cast<double>(sphere.center.x), static_cast<double>(sphere.center.y),
                                static_cast<double>(sphere.center.z));
  // Three roundings of at most half an ulp each happen below; four ulps more hold them.
  constexpr double kGuard = 1 + 4 * std::numeric_limits<double>::epsilon();
  const double needed = (ball.radius + (rounded - ball.center).norm()) * kGuard;
  sphere.radius = nearestFloat(needed);
  if (static_cast<double>(sphere.radius) < needed) {
    sphere.radius = std::nextafter(sphere.radius, std::numeric_limits<float>::infinity());
  }
  return sphere;
}

Result<SphereTree> finalize(const BallTree& tree) {
  std::vector<SphereTree::Entry> entries;
  std::uint32_t levelStart = 0;
  for (std::size_t level = 0; level < tree.levels.size(); ++level) {
    const auto nextStart = static_cast<std::uint32_t>(entries.size());
    for (const BallTree::Node& node : tree.levels[level]) {
      medial::Ball ball = node.ball;
      ball.radius += kOwnSlack * ball.radius + kRootSlack * tree.levels[0][0].ball.radius;
      entries.push_back({toSphere(ball), level == 0 ? kNoParent : levelStart + node.parent});
    }
    levelStart = nextStart;
  }
  return SphereTree::create(entries);
}

}  // namespace spheretree::builders
