// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/solid_cover.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "medial/solid_cells.hpp"
#include "solids.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;
using medial::Context;
using medial::Random;
using medial::Surface;

/// Balls around the cells of a grid over the surface of a cube of side 1, and over its inside if wanted.
std::vector<Ball> cellsOf(int n, bool withInside) {
  std::vector<Ball> balls;
  const double cell = 1.0 / n;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z) {
        const bool atSurface = std::min({x, y, z}) == 0 || std::max({x, y, z}) == n - 1;
        if (!atSurface && !withInside) continue;
        const Vector3d center =
            (Vector3d(x, y, z) + Vector3d::Constant(0.5)) * cell - Vector3d::Constant(0.5);
        balls.push_back(ballAround(boxAt(center, Vector3d::Constant(cell))));
      }
    }
  }
  return balls;
}

double sampledUncovered(std::span<const Ball> balls, int samples, Random& random) {
  int outside = 0;
  for (int k = 0; k < samples; ++k) {
    const Vector3d p = randomIn(random, boxAt({0, 0, 0}, {1, 1, 1}));
    outside += std::none_of(balls.begin(), balls.end(), [&](const Ball& ball) {
      return (p - ball.center).squaredNorm() <= ball.radius * ball.radius;
    });
  }
  return static_cast<double>(outside) / samples;
}

TEST(SolidCover, IsProvedForTheBallAroundABox) {
  const Surface box = boxSurface(1, 2, 3);
  const SolidCover cover = measureSolidCover(box, std::vector<Ball>{ballAround(box.bounds())}, 0, Context(1));
  EXPECT_TRUE(cover.certified);
  EXPECT_EQ(cover.uncovered.upper, 0);
}

TEST(SolidCover, IsProvedForAFullGridAndARoundSolid) {
  const Surface cube = boxSurface(1, 1, 1);
  auto grid = cellsOf(5, true);
  for (Ball& ball : grid) ball.radius *= 1.01;
  EXPECT_TRUE(measureSolidCover(cube, grid, 1e-3, Context(2)).certified);
  const Surface ball = surfaceOf(models::makeBall(1, 3));
  EXPECT_TRUE(
      measureSolidCover(ball, std::vector<Ball>{{Vector3d::Zero(), 1 + 1e-6}}, 1e-3, Context(1)).certified);
}

TEST(SolidCover, IsProvedAtOnceForTheCellsOfItsOwnOctree) {
  // Balls that touch in masses of points; the proof splits where the builder did.
  const Surface torus = surfaceOf(models::makeTorus(1, 0.3, 24, 12));
  std::vector<Ball> balls;
  for (const auto& octant : medial::octants(medial::solidRootCube(torus))) {
    for (const auto& cell : medial::octants(octant)) balls.push_back(ballAround(cell));
  }
  const SolidCover cover = measureSolidCover(torus, balls, 1e-3, Context(1));
  EXPECT_TRUE(cover.certified);
  EXPECT_EQ(cover.effort.deepest, 2U);
}

TEST(SolidCover, OfNoBallsIsNothing) {
  const SolidCover cover = measureSolidCover(boxSurface(1, 1, 1), {}, 1e-2, Context(1));
  EXPECT_FALSE(cover.certified);
  EXPECT_GT(cover.uncovered.lower, 0.99);
  EXPECT_LE(cover.uncovered.lower, 1);
  EXPECT_GE(cover.uncovered.upper, 1 - 1e-12);
}

TEST(SolidCover, LacksTheCoreOfAShell) {
  const std::uint64_t seed = 3;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Random random(seed);
  const Surface cube = boxSurface(1, 1, 1);
  for (const int n : {5, 8}) {
    const auto shell = cellsOf(n, false);
    const SolidCover cover = measureSolidCover(cube, shell, 1e-2, Context(2));
    constexpr int kSamples = 100'000;
    const double truth = sampledUncovered(shell, kSamples, random);
    const double sigma = std::sqrt(truth * (1 - truth) / kSamples);
    EXPECT_FALSE(cover.certified);
    EXPECT_GT(cover.uncovered.lower, 0);
    EXPECT_LE(cover.uncovered.lower, truth + 5 * sigma);
    EXPECT_GE(cover.uncovered.upper, truth - 5 * sigma);
    EXPECT_LE(cover.uncovered.upper - cover.uncovered.lower, 1e-2);
  }
}

TEST(SolidCover, LacksWhatOneBallLeavesOver) {
  struct Case {
    const char* what;
    Surface solid;
    Ball ball;
    double fraction;  // of the ball that lies in the solid
  };
  std::vector<Case> cases;
  cases.push_back({"inside a cube", boxSurface(1, 1, 1), {Vector3d::Zero(), 0.5}, 1});
  cases.push_back({"on a face", boxSurface(1, 1, 1), {Vector3d(0.5, 0.1, 0.05), 0.3}, 0.5});
  cases.push_back({"on an edge", boxSurface(1, 1, 1), {Vector3d(0.5, -0.5, 0.1), 0.3}, 0.25});
  cases.push_back({"on a corner", boxSurface(1, 1, 1), {Vector3d(0.5, -0.5, 0.5), 0.7}, 0.125});
  Surface block = surfaceOf(models::makeLBlock());
  const Vector3d hollowEdge = block.bounds().center();
  cases.push_back({"on a hollow edge", std::move(block), {hollowEdge, 0.4}, 0.75});
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    const double ball = 4 * std::numbers::pi / 3 * std::pow(c.ball.radius, 3);
    const double truth = 1 - c.fraction * ball / c.solid.volume();
    const SolidCover cover = measureSolidCover(c.solid, std::vector<Ball>{c.ball}, 1e-7, Context(2));
    EXPECT_FALSE(cover.certified);
    EXPECT_LE(cover.uncovered.lower, truth);
    EXPECT_GE(cover.uncovered.upper, truth);
    EXPECT_LE(cover.uncovered.upper - cover.uncovered.lower, 1e-7);
  }
}

TEST(SolidCover, LacksNothingInACavity) {
  const Surface shell = surfaceOf(models::makeHollowBall(1, 0.5, 2));
  const SolidCover nothing = measureSolidCover(shell, {}, 1e-3, Context(2));
  EXPECT_LE(nothing.uncovered.lower, 1);
  EXPECT_GE(nothing.uncovered.upper, 1 - 1e-9);
  EXPECT_LE(nothing.uncovered.upper - nothing.uncovered.lower, 1e-3);
  // A ball that fills the cavity and no more covers nothing of the solid.
  const double cavity = -shell.depth(Vector3d::Zero());
  const std::vector<Ball> filling{{Vector3d::Zero(), cavity}};
  const SolidCover cover = measureSolidCover(shell, filling, 1e-3, Context(2));
  EXPECT_GE(cover.uncovered.upper, 1 - 1e-9);
  EXPECT_GE(cover.uncovered.lower, 1 - 1e-3);
}

TEST(SolidCover, AgreesWithRandomSampling) {
  constexpr int kSamples = 60'000;
  std::vector<Surface> solids;
  solids.push_back(surfaceOf(models::makeTorus(1, 0.3, 24, 12)));
  solids.push_back(surfaceOf(models::makeComb(3)));
  solids.push_back(surfaceOf(models::makeGear(8)));
  for (const Surface& solid : solids) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed);
      Random random(seed);
      std::vector<Ball> balls;
      for (int k = 0; k < 40; ++k) {
        balls.push_back({randomIn(random, solid.bounds()), random.uniform(0.05, 0.12) * solid.diagonal()});
      }
      const SolidCover cover = measureSolidCover(solid, balls, 1e-2, Context(2));
      EXPECT_LE(cover.uncovered.upper - cover.uncovered.lower, 1e-2);
      int inside = 0;
      int outside = 0;
      for (int k = 0; k < kSamples; ++k) {
        const Vector3d p = randomIn(random, solid.bounds());
        if (!solid.inside(p)) continue;
        ++inside;
        outside += std::none_of(balls.begin(), balls.end(), [&](const Ball& ball) {
          return (p - ball.center).squaredNorm() <= ball.radius * ball.radius;
        });
      }
      const double truth = static_cast<double>(outside) / inside;
      const double sigma = std::sqrt(truth * (1 - truth) / inside);
      EXPECT_LE(cover.uncovered.lower, truth + 5 * sigma);
      EXPECT_GE(cover.uncovered.upper, truth - 5 * sigma);
    }
  }
}

TEST(SolidCover, SpendsALimitedEffort) {
  const Surface torus = surfaceOf(models::makeTorus(1, 0.3, 32, 16));
  Random random(8);
  std::vector<Ball> balls;
  for (int k = 0; k < 60; ++k) balls.push_back({randomIn(random, torus.bounds()), 0.2});
  const SolidCover cover = measureSolidCover(torus, balls, 1e-12, Context(2));
  EXPECT_FALSE(cover.certified);
  EXPECT_LE(cover.effort.cells, 300'000U);
  EXPECT_LT(cover.uncovered.lower, cover.uncovered.upper);
}

TEST(SolidCover, DoesNotDependOnThreads) {
  const Surface cube = boxSurface(1, 1, 1);
  const auto shell = cellsOf(6, false);
  const SolidCover one = measureSolidCover(cube, shell, 3e-2, Context(1));
  const SolidCover three = measureSolidCover(cube, shell, 3e-2, Context(3));
  EXPECT_EQ(one.uncovered.lower, three.uncovered.lower);
  EXPECT_EQ(one.uncovered.upper, three.uncovered.upper);
  EXPECT_EQ(one.effort.cells, three.effort.cells);
}

/// A root around the unit cube and the given balls below it.
SphereTree twoLevels(const std::vector<Ball>& balls) {
  std::vector<std::pair<Ball, std::uint32_t>> nodes{{ballAround(boxAt({0, 0, 0}, {1, 1, 1})), 0}};
  for (const Ball& ball : balls) nodes.push_back({ball, 0});
  return treeOf(nodes);
}

TEST(SolidChains, HoldForAFullGridAndBreakForAShell) {
  const Surface cube = boxSurface(1, 1, 1);
  EXPECT_TRUE(proveSolidChains(cube, twoLevels(cellsOf(4, true)), Context(2)).certified);
  const SphereTree shell = twoLevels(cellsOf(6, false));
  EXPECT_TRUE(proveSurfaceChains(cube, shell, Context(2)).certified);
  const ChainProof proof = proveSolidChains(cube, shell, Context(2));
  EXPECT_FALSE(proof.certified);
  EXPECT_EQ(proof.failedLevel, 1U);
}

TEST(SolidChains, BreakWhenPartsHangBelowTheWrongWhole) {
  const Surface bar = boxSurface(2, 1, 1);
  const Ball whole = ballAround(bar.bounds());
  const Ball left = ballAround(boxAt({-0.5, 0, 0}, {1, 1, 1}));
  const Ball right = ballAround(boxAt({0.5, 0, 0}, {1, 1, 1}));
  const auto tree = [&](const Ball& belowLeft, const Ball& belowRight) {
    return treeOf({{whole, 0}, {left, 0}, {right, 0}, {belowLeft, 1}, {belowRight, 2}});
  };
  EXPECT_TRUE(proveSolidChains(bar, tree(left, right), Context(1)).certified);
  const ChainProof proof = proveSolidChains(bar, tree(right, left), Context(1));
  EXPECT_FALSE(proof.certified);
  EXPECT_EQ(proof.failedLevel, 2U);
}

}  // namespace
}  // namespace spheretree::builders
