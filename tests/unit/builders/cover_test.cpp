// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/cover.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "builders/metrics.hpp"
#include "medial/cell_set.hpp"
#include "solids.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Ball;
using medial::Context;
using medial::Random;
using medial::Surface;

constexpr double kPi = std::numbers::pi;

double distanceTo(std::span<const Ball> balls, const Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Ball& ball : balls) nearest = std::min(nearest, (point - ball.center).norm() - ball.radius);
  return nearest;
}

/// Balls around the cells of a grid over the surface of a cube of side 1.
std::vector<Ball> shellOf(int n, double growth) {
  std::vector<Ball> balls;
  const double cell = 1.0 / n;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const double side : {-0.5, 0.5}) {
      for (int u = 0; u < n; ++u) {
        for (int v = 0; v < n; ++v) {
          Vector3d center;
          center[axis] = side;
          center[(axis + 1) % 3] = (u + 0.5) * cell - 0.5;
          center[(axis + 2) % 3] = (v + 0.5) * cell - 0.5;
          balls.push_back({center, growth * cell * std::sqrt(0.5)});
        }
      }
    }
  }
  return balls;
}

TEST(SurfaceCover, IsProvedForTheBallAroundABox) {
  const Surface box = boxSurface(1, 2, 3);
  const std::vector<Ball> balls{ballAround(box.bounds())};
  const SurfaceCover cover = measureSurfaceCover(box, balls, Context(1));
  EXPECT_TRUE(cover.certified);
  EXPECT_EQ(cover.uncovered.upper, 0);
  EXPECT_EQ(cover.distance.upper, 0);
  EXPECT_EQ(cover.effort.cells, 12U);
  EXPECT_EQ(cover.effort.deepest, 0U);
}

TEST(SurfaceCover, IsProvedBySubdivisionForManySmallBalls) {
  const Surface cube = boxSurface(1, 1, 1);
  for (const int n : {2, 3, 8}) {
    const SurfaceCover cover = measureSurfaceCover(cube, shellOf(n, 1 + 1e-6), Context(1));
    EXPECT_TRUE(cover.certified) << n;
    EXPECT_GT(cover.effort.deepest, 0U);
  }
}

TEST(SurfaceCover, MissesTheCornersThatATooSmallBallLeaves) {
  const Surface cube = boxSurface(1, 1, 1);
  for (const double shortfall : {1e-6, 1e-4, 1e-2, 0.1}) {
    SCOPED_TRACE(testing::Message() << "shortfall " << shortfall);
    const double radius = std::sqrt(0.75) * (1 - shortfall);
    const SurfaceCover cover =
        measureSurfaceCover(cube, std::vector<Ball>{{Vector3d::Zero(), radius}}, Context(1));
    // Each face: a unit square without a disc that bulges over its four sides.
    const double disc = std::sqrt(radius * radius - 0.25);
    const double half = 0.5;
    const double segment = disc * disc * std::acos(half / disc) - half * std::sqrt(disc * disc - half * half);
    const double expected = 1 - (kPi * disc * disc - 4 * segment);
    EXPECT_FALSE(cover.certified);
    EXPECT_LE(cover.uncovered.lower, expected + 1e-11);
    EXPECT_GE(cover.uncovered.upper, expected - 1e-11);
    EXPECT_LE(cover.uncovered.upper - cover.uncovered.lower, 1e-10);
    const double missed = std::sqrt(0.75) * shortfall;
    EXPECT_LE(cover.distance.lower, missed + 1e-12);
    EXPECT_GE(cover.distance.upper, missed - 1e-12);
    EXPECT_LE(cover.distance.upper - cover.distance.lower, std::max(0.01 * missed, 1.8e-5));
  }
}

TEST(SurfaceCover, OfNoBallsIsNothing) {
  const SurfaceCover cover = measureSurfaceCover(boxSurface(1, 1, 1), {}, Context(1));
  EXPECT_FALSE(cover.certified);
  EXPECT_NEAR(cover.uncovered.lower, 1, 1e-9);
  EXPECT_EQ(cover.uncovered.upper, 1);
  EXPECT_TRUE(std::isinf(cover.distance.lower));
}

TEST(SurfaceCover, SeesABallThatTouchesOnlyTheInsideOfATriangle) {
  // No corner of the mesh is near the ball.
  const Surface cube = boxSurface(1, 1, 1);
  const double radius = 0.2;
  const Vector3d center(0.5, 0.25, 0.1);  // on a face, across no edge but perhaps its diagonal
  const SurfaceCover cover = measureSurfaceCover(cube, std::vector<Ball>{{center, radius}}, Context(1));
  EXPECT_NEAR(cover.uncovered.lower, 1 - kPi * radius * radius / 6, 1e-10);
  // Farthest is a corner of the opposite face.
  EXPECT_NEAR(cover.distance.lower, (Vector3d(-0.5, -0.5, -0.5) - center).norm() - radius, 1e-9);
}

TEST(SurfaceCover, AgreesWithRandomSampling) {
  constexpr int kSamples = 40'000;
  std::vector<Surface> solids;
  solids.push_back(boxSurface(1, 1, 1));
  solids.push_back(surfaceOf(models::makeTorus(1, 0.3, 24, 12)));
  for (const Surface& solid : solids) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed);
      Random random(seed);
      std::vector<Ball> balls;
      for (int k = 0; k < 150; ++k)
        balls.push_back({randomIn(random, solid.bounds()), random.uniform(0.05, 0.3)});
      const SurfaceCover cover = measureSurfaceCover(solid, balls, Context(1));
      ASSERT_FALSE(cover.certified);
      EXPECT_LE(cover.distance.upper - cover.distance.lower,
                std::max(0.01 * cover.distance.upper, 1e-5 * solid.diagonal()) + 1e-12);
      double missed = 0;
      double variance = 0;
      for (std::size_t t = 0; t < solid.mesh().triangles.size(); ++t) {
        const medial::SurfaceCell cell{solid.mesh().corner(t, 0), solid.mesh().corner(t, 1),
                                       solid.mesh().corner(t, 2)};
        const double share = medial::areaOf(cell) / solid.area();
        const int samples = static_cast<int>(std::ceil(kSamples * share));
        int outside = 0;
        for (int k = 0; k < samples; ++k) {
          double u = random.uniform();
          double v = random.uniform();
          if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
          }
          const double distance =
              distanceTo(balls, cell[0] + u * (cell[1] - cell[0]) + v * (cell[2] - cell[0]));
          outside += distance > 0 ? 1 : 0;
          EXPECT_LE(distance, cover.distance.upper + 1e-12);
        }
        const double p = static_cast<double>(outside) / samples;
        missed += share * p;
        variance += share * share * p * (1 - p) / samples;
      }
      EXPECT_NEAR((cover.uncovered.lower + cover.uncovered.upper) / 2, missed,
                  5 * std::sqrt(variance) + 1e-4);
      EXPECT_LE(cover.uncovered.upper - cover.uncovered.lower, 1e-8);
    }
  }
}

TEST(SurfaceCover, DoesNotDependOnThreads) {
  const Surface torus = surfaceOf(models::makeTorus(1, 0.3, 24, 12));
  Random random(5);
  std::vector<Ball> balls;
  for (int k = 0; k < 100; ++k) balls.push_back({randomIn(random, torus.bounds()), 0.25});
  const SurfaceCover one = measureSurfaceCover(torus, balls, Context(1));
  const SurfaceCover three = measureSurfaceCover(torus, balls, Context(3));
  EXPECT_EQ(one.uncovered.lower, three.uncovered.lower);
  EXPECT_EQ(one.distance.upper, three.distance.upper);
  EXPECT_EQ(one.effort.cells, three.effort.cells);
}

/// A bar of 2 x 1 x 1, its halves and its quarters along x, each with the ball around it.
struct Bar {
  Surface surface = boxSurface(2, 1, 1);
  Ball whole = ballAround(surface.bounds());
  std::array<Ball, 2> half{ballAround(boxAt({-0.5, 0, 0}, {1, 1, 1})),
                           ballAround(boxAt({0.5, 0, 0}, {1, 1, 1}))};
  std::array<Ball, 4> quarter{
      ballAround(boxAt({-0.75, 0, 0}, {0.5, 1, 1})), ballAround(boxAt({-0.25, 0, 0}, {0.5, 1, 1})),
      ballAround(boxAt({0.25, 0, 0}, {0.5, 1, 1})), ballAround(boxAt({0.75, 0, 0}, {0.5, 1, 1}))};
};

TEST(SurfaceChains, HoldWhenEachPartIsBelowItsWhole) {
  const Bar bar;
  const SphereTree tree = treeOf({{bar.whole, 0},
                                  {bar.half[0], 0},
                                  {bar.half[1], 0},
                                  {bar.quarter[0], 1},
                                  {bar.quarter[1], 1},
                                  {bar.quarter[2], 2},
                                  {bar.quarter[3], 2}});
  const ChainProof proof = proveSurfaceChains(bar.surface, tree, Context(1));
  EXPECT_TRUE(proof.certified);
  EXPECT_GE(proof.effort.cells, 12U);
}

TEST(SurfaceChains, BreakWhenPartsHangBelowTheWrongWhole) {
  const Bar bar;
  const SphereTree tree = treeOf({{bar.whole, 0},
                                  {bar.half[0], 0},
                                  {bar.half[1], 0},
                                  {bar.quarter[2], 1},
                                  {bar.quarter[3], 1},
                                  {bar.quarter[0], 2},
                                  {bar.quarter[1], 2}});
  for (std::size_t level = 0; level < 3; ++level) {
    EXPECT_TRUE(measureSurfaceCover(bar.surface, ballsOf(tree.level(level)), Context(1)).certified) << level;
  }
  const ChainProof proof = proveSurfaceChains(bar.surface, tree, Context(1));
  EXPECT_FALSE(proof.certified);
  EXPECT_EQ(proof.failedLevel, 2U);
  EXPECT_LT(proof.failedTriangle, bar.surface.mesh().triangles.size());
}

TEST(SurfaceChains, LetAChildlessNodeStandForItselfBelow) {
  const Bar bar;
  const SphereTree tree =
      treeOf({{bar.whole, 0}, {bar.half[0], 0}, {bar.half[1], 0}, {bar.quarter[0], 1}, {bar.quarter[1], 1}});
  EXPECT_TRUE(proveSurfaceChains(bar.surface, tree, Context(1)).certified);
  // But not for its brother.
  const SphereTree gap = treeOf({{bar.whole, 0}, {bar.half[0], 0}, {bar.half[1], 0}, {bar.quarter[0], 1}});
  const ChainProof proof = proveSurfaceChains(bar.surface, gap, Context(1));
  EXPECT_FALSE(proof.certified);
  EXPECT_EQ(proof.failedLevel, 2U);
}

TEST(SurfaceChains, StartAtTheRoot) {
  const Bar bar;
  const SphereTree tree = treeOf({{bar.half[0], 0}, {bar.half[0], 0}, {bar.half[1], 0}});
  const ChainProof proof = proveSurfaceChains(bar.surface, tree, Context(1));
  EXPECT_FALSE(proof.certified);
  EXPECT_EQ(proof.failedLevel, 0U);
}

TEST(SurfaceChains, GoWhereverTheSurfaceGoes) {
  // Children need not lie inside their parents: each half's ball is here handed to the other half's parent,
  // and both parents hold everything.
  const Bar bar;
  const SphereTree tree =
      treeOf({{bar.whole, 0}, {bar.whole, 0}, {bar.whole, 0}, {bar.half[1], 1}, {bar.half[0], 2}});
  EXPECT_TRUE(proveSurfaceChains(bar.surface, tree, Context(2)).certified);
}

}  // namespace
}  // namespace spheretree::builders
