// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/finalize.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace spheretree::builders {
namespace {

constexpr double kCoverSlack = 1e-6;

}  // namespace

Sphere toSphere(const medial::Ball& ball) {
  Sphere sphere;
  sphere.center = {static_cast<float>(ball.center.x()), static_cast<float>(ball.center.y()),
                   static_cast<float>(ball.center.z())};
  const Eigen::Vector3d rounded(static_cast<double>(sphere.center.x), static_cast<double>(sphere.center.y),
                                static_cast<double>(sphere.center.z));
  // Three roundings of at most half an ulp each happen below; four ulps more hold them.
  constexpr double kGuard = 1 + 4 * std::numeric_limits<double>::epsilon();
  const double needed = (ball.radius + (rounded - ball.center).norm()) * kGuard;
  sphere.radius = static_cast<float>(needed);
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
      ball.radius *= 1 + kCoverSlack;
      entries.push_back({toSphere(ball), level == 0 ? kNoParent : levelStart + node.parent});
    }
    levelStart = nextStart;
  }
  return SphereTree::create(entries);
}

}  // namespace spheretree::builders
