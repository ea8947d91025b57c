// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <gtest/gtest.h>

#include "solids.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;
using medial::Context;
using medial::Surface;

TEST(LevelMetrics, OfOneBallAroundACube) {
  const Surface cube = boxSurface(2, 2, 2);
  const std::vector<Ball> balls{ballAround(cube.bounds())};
  const LevelMetrics metrics = measureLevel(cube, balls, Context(1));
  const double radius = balls[0].radius;
  EXPECT_EQ(metrics.spheres, 1U);
  EXPECT_TRUE(metrics.surface.certified);
  EXPECT_TRUE(metrics.solid.certified);
  EXPECT_LE(metrics.overhangWorst.lower, radius - 1 + 1e-12);
  EXPECT_GE(metrics.overhangWorst.upper, radius - 1);
  EXPECT_LE(metrics.overhangWorst.upper - metrics.overhangWorst.lower, 0.01 * metrics.overhangWorst.upper);
  EXPECT_EQ(metrics.overhangMean, metrics.overhangWorst.upper);
  EXPECT_NEAR(metrics.volume, 4 * std::numbers::pi / 3 * radius * radius * radius, 1e-10);
  EXPECT_NEAR(metrics.volumeRatio, metrics.volume / 8, 1e-12);
}

TEST(LevelMetrics, NameTheWorstBallAndAverageTheRest) {
  const Surface cube = boxSurface(2, 2, 2);
  // Overhangs 0, 0.5, 0.25, and a ball far away.
  const std::vector<Ball> balls{
      {Vector3d::Zero(), 0.9}, {Vector3d(0.5, 0, 0), 1}, {Vector3d(0, 0.25, 0), 1}, {Vector3d(4, 0, 0), 0.5}};
  const LevelMetrics metrics = measureLevel(cube, balls, Context(2));
  EXPECT_EQ(metrics.worstBall, 3U);
  ASSERT_EQ(metrics.ballOverhang.size(), 4U);
  const double expected[] = {0, 0.5, 0.25, 3.5};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(metrics.ballOverhang[i], expected[i], 0.01 * expected[i] + 1e-9);
  EXPECT_NEAR(metrics.overhangMean, 4.25 / 4, 0.01 * 4.25 / 4);
  EXPECT_FALSE(metrics.surface.certified);
  EXPECT_FALSE(metrics.solid.certified);
}

TEST(LevelMetrics, TellLevelsApartThatDifferByAThousandth) {
  const Surface cube = boxSurface(2, 2, 2);
  // Balls around corners stick out by their radius: one a thousandth more than the other, which a bracket of
  // one per cent would not say.
  const std::vector<Ball> balls{{Vector3d(1, 1, 1), 1}, {Vector3d(-1, 1, 1), 1.001}};
  const LevelMetrics first = measureLevel(cube, std::span(balls.data(), 1), Context(1));
  const LevelMetrics second = measureLevel(cube, std::span(balls.data() + 1, 1), Context(1));
  EXPECT_LT(first.overhangWorst.upper, second.overhangWorst.lower);
  EXPECT_NEAR(first.overhangWorst.upper, 1, 1e-4);
  const LevelMetrics both = measureLevel(cube, balls, Context(1));
  EXPECT_EQ(both.worstBall, 1U);
  EXPECT_NEAR(both.overhangWorst.upper, 1.001, 1e-4);
  EXPECT_NEAR(both.overhangWorst.lower, 1.001, 2e-4);
}

TEST(LevelMetrics, ScaleWithTheMesh) {
  const std::vector<Ball> balls{{Vector3d(0.2, 0.1, 0), 0.6}, {Vector3d(-0.3, 0, 0.1), 0.5}};
  const LevelMetrics plain = measureLevel(boxSurface(1, 1, 1), balls, Context(1));
  constexpr double kScale = 0x1.0p-20;  // about a millionth, exact
  std::vector<Ball> small;
  for (const Ball& ball : balls) small.push_back({kScale * ball.center, kScale * ball.radius});
  const LevelMetrics scaled = measureLevel(boxSurface(kScale, kScale, kScale), small, Context(1));
  EXPECT_NEAR(scaled.overhangWorst.upper / kScale, plain.overhangWorst.upper,
              0.01 * plain.overhangWorst.upper);
  EXPECT_NEAR(scaled.surface.uncovered.upper, plain.surface.uncovered.upper, 1e-9);
  EXPECT_NEAR(scaled.volumeRatio, plain.volumeRatio, 1e-12);
}

TEST(LevelMetrics, DoNotDependOnThreads) {
  const Surface torus = surfaceOf(models::makeTorus(1, 0.3, 24, 12));
  medial::Random random(21);
  std::vector<Ball> balls;
  for (int k = 0; k < 40; ++k) balls.push_back({randomIn(random, torus.bounds()), 0.4});
  const LevelMetrics one = measureLevel(torus, balls, Context(1));
  const LevelMetrics three = measureLevel(torus, balls, Context(3));
  EXPECT_EQ(one.overhangMean, three.overhangMean);
  EXPECT_EQ(one.ballOverhang, three.ballOverhang);
  EXPECT_EQ(one.surface.uncovered.upper, three.surface.uncovered.upper);
  EXPECT_EQ(one.solid.uncovered.upper, three.solid.uncovered.upper);
  EXPECT_EQ(one.volume, three.volume);
}

TEST(LevelMetrics, ReadTheBallsOfATreeExactly) {
  const SphereTree tree = treeOf({{{Vector3d(0.5, -0.25, 3), 2}, 0}, {{Vector3d(1, 0, 0), 0.125}, 0}});
  const auto balls = ballsOf(tree.level(1));
  ASSERT_EQ(balls.size(), 1U);
  EXPECT_EQ(balls[0].center, Vector3d(1, 0, 0));
  EXPECT_EQ(balls[0].radius, 0.125);
}

}  // namespace
}  // namespace spheretree::builders
