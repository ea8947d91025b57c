// SPDX-License-Identifier: GPL-3.0-or-later
//
// The row of figures that a report has for each level: docs/error-metrics.md.

#include "builders/metrics.hpp"

#include <algorithm>

#include "builders/union_volume.hpp"
#include "medial/parallel.hpp"

namespace spheretree::builders {
namespace {

/// Every ball's overhang is known to this fraction of itself or of the diagonal, and with it worst and mean.
constexpr double kRelativeGap = 1e-2;
constexpr double kAbsoluteGap = 1e-5;
/// How well the uncovered part of the volume is wanted, as a fraction of the volume.
constexpr double kSolidGap = 1e-3;

void measureOverhang(LevelMetrics& metrics, const medial::Surface& surface,
                     std::span<const medial::Ball> balls, const medial::Context& context) {
  std::vector<Bounds> bounds(balls.size());
  medial::parallelFor(balls.size(), context, [&](std::size_t i) {
    bounds[i] = boundOverhang(surface, balls[i], kRelativeGap, kAbsoluteGap * surface.diagonal()).value;
  });
  double sum = 0;
  metrics.ballOverhang.reserve(balls.size());
  for (std::uint32_t i = 0; i < balls.size(); ++i) {
    metrics.overhangWorst.lower = std::max(metrics.overhangWorst.lower, bounds[i].lower);
    if (bounds[i].upper > metrics.overhangWorst.upper) {
      metrics.overhangWorst.upper = bounds[i].upper;
      metrics.worstBall = i;
    }
    metrics.ballOverhang.push_back(bounds[i].upper);
    sum += bounds[i].upper;
  }
  if (!balls.empty()) metrics.overhangMean = sum / static_cast<double>(balls.size());
}

}  // namespace

LevelMetrics measureLevel(const medial::Surface& surface, std::span<const medial::Ball> balls,
                          const medial::Context& context) {
  LevelMetrics metrics;
  metrics.spheres = balls.size();
  measureOverhang(metrics, surface, balls, context);
  metrics.surface = measureSurfaceCover(surface, balls, context);
  metrics.solid = measureSolidCover(surface, balls, kSolidGap, context);
  metrics.volume = unionVolume(balls);
  metrics.volumeRatio = metrics.volume / surface.volume();
  return metrics;
}

std::vector<medial::Ball> ballsOf(std::span<const Node> nodes) {
  std::vector<medial::Ball> balls;
  balls.reserve(nodes.size());
  for (const Node& node : nodes) {
    const Eigen::Vector3d center(static_cast<double>(node.ball.center.x),
                                 static_cast<double>(node.ball.center.y),
                                 static_cast<double>(node.ball.center.z));
    balls.push_back({center, static_cast<double>(node.ball.radius)});
  }
  return balls;
}

}  // namespace spheretree::builders
