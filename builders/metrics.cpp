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
  const LevelOverhang found = levelOverhang(surface, balls, context);
  metrics.overhangWorst = found.worst;
  metrics.worstBall = found.worstBall;
  metrics.ballOverhang.reserve(balls.size());
  double sum = 0;
  for (const Bounds& ball : found.balls) {
    metrics.ballOverhang.push_back(ball.upper);
    sum += ball.upper;
  }
  if (!balls.empty()) metrics.overhangMean = sum / static_cast<double>(balls.size());
}

}  // namespace

LevelOverhang levelOverhang(const medial::Surface& surface, std::span<const medial::Ball> balls,
                            const medial::Context& context, const Sharpness& sharpness) {
  const double absoluteGap = kAbsoluteGap * surface.diagonal();
  LevelOverhang result;
  result.balls.resize(balls.size());
  medial::parallelFor(balls.size(), context, [&](std::size_t i) {
    result.balls[i] = boundOverhang(surface, balls[i], kRelativeGap, absoluteGap).value;
  });
  // The worst one is looked at again, and so is whichever may then be the worst.
  std::vector<bool> sharp(balls.size(), false);
  for (std::uint32_t looks = 0; !balls.empty(); ++looks) {
    const auto lower = [](const Bounds& a, const Bounds& b) { return a.upper < b.upper; };
    const auto worst = std::max_element(result.balls.begin(), result.balls.end(), lower);
    const auto i = static_cast<std::size_t>(worst - result.balls.begin());
    result.worstBall = static_cast<std::uint32_t>(i);
    if (sharp[i] || looks == sharpness.mostBalls) break;
    const Bounds again =
        boundOverhang(surface, balls[i], sharpness.relativeGap, sharpness.relativeGap * absoluteGap).value;
    *worst = {std::max(worst->lower, again.lower), std::min(worst->upper, again.upper)};
    sharp[i] = true;
  }
  for (const Bounds& ball : result.balls) {
    result.worst.lower = std::max(result.worst.lower, ball.lower);
    result.worst.upper = std::max(result.worst.upper, ball.upper);
  }
  return result;
}

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
