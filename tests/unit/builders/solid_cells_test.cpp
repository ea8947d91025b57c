// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/solid_cells.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "solids.hpp"

namespace spheretree::medial {
namespace {

using builders::boxAt;
using builders::boxSurface;
using builders::randomIn;
using builders::surfaceOf;
using Eigen::AlignedBox3d;
using Eigen::Vector3d;

std::vector<Vector3d> pointsIn(const Surface& surface, const AlignedBox3d& cube) {
  return solidPoints(surface, cube, surface.trianglesNear(cube));
}

AlignedBox3d boundsOfPoints(const std::vector<Vector3d>& points) {
  AlignedBox3d box;
  for (const Vector3d& p : points) box.extend(p);
  return box;
}

TEST(SolidCells, OctantsTileTheirCube) {
  const AlignedBox3d cube(Vector3d(-1, 0, 2), Vector3d(1, 2, 4));
  double volume = 0;
  AlignedBox3d all;
  for (const AlignedBox3d& octant : octants(cube)) {
    volume += octant.volume();
    all.extend(octant);
    EXPECT_TRUE(cube.contains(octant));
  }
  EXPECT_EQ(volume, cube.volume());
  EXPECT_TRUE(all.isApprox(cube, 0));
}

TEST(SolidCells, RootCubeHoldsTheSolid) {
  const Surface surface = boxSurface(1, 2, 3);
  const AlignedBox3d root = solidRootCube(surface);
  EXPECT_TRUE(root.contains(surface.bounds()));
  EXPECT_DOUBLE_EQ(root.sizes().x(), root.sizes().z());
  EXPECT_LT(root.sizes().x(), 3.1);
}

TEST(SolidCells, PointsOfAnInnerCubeAreItsCorners) {
  const Surface surface = boxSurface(2, 2, 2);
  const AlignedBox3d cube = boxAt({0.1, 0.2, 0.3}, Vector3d::Constant(0.5));
  const auto points = pointsIn(surface, cube);
  EXPECT_EQ(points.size(), 8U);
  EXPECT_TRUE(boundsOfPoints(points).isApprox(cube, 0));
}

TEST(SolidCells, PointsOfAnEmptyCubeAreNone) {
  const Surface surface = boxSurface(2, 2, 2);
  EXPECT_TRUE(pointsIn(surface, boxAt({1.6, 0, 0}, Vector3d::Constant(1))).empty());
  // In the cavity of a shell.
  const Surface shell = surfaceOf(models::makeHollowBall(1, 0.5, 2));
  EXPECT_TRUE(pointsIn(shell, boxAt({0, 0, 0}, Vector3d::Constant(0.4))).empty());
}

TEST(SolidCells, PointsOfACutCubeEndAtTheSurface) {
  const Surface surface = boxSurface(2, 2, 2);
  const AlignedBox3d cube = boxAt({1, 0.1, 0}, Vector3d::Constant(0.5));
  const AlignedBox3d expected(Vector3d(0.75, -0.15, -0.25), Vector3d(1, 0.35, 0.25));
  const AlignedBox3d found = boundsOfPoints(pointsIn(surface, cube));
  EXPECT_TRUE(found.isApprox(expected, 1e-12));
}

TEST(SolidCells, PointsOfACubeAroundASolidAreItsCorners) {
  const Surface surface = boxSurface(1, 1, 1);
  const auto points = pointsIn(surface, boxAt({0, 0, 0}, Vector3d::Constant(4)));
  EXPECT_EQ(points.size(), 8U);  // each used by several triangles, listed once
}

TEST(SolidCells, HullOfThePointsHoldsTheSolidInTheCube) {
  const std::uint64_t seed = 11;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Random random(seed);
  std::vector<Surface> solids;
  solids.push_back(surfaceOf(models::makeTorus(1, 0.3, 16, 8)));
  solids.push_back(surfaceOf(models::makeComb(3)));
  solids.push_back(surfaceOf(models::makeHollowBall(1, 0.7, 2)));
  for (const Surface& solid : solids) {
    for (int k = 0; k < 60; ++k) {
      const double side = random.uniform(0.05, 0.5) * solid.diagonal();
      const AlignedBox3d cube = boxAt(randomIn(random, solid.bounds()), Vector3d::Constant(side));
      const auto points = pointsIn(solid, cube);
      std::vector<Vector3d> samples;
      for (int s = 0; s < 200; ++s) {
        const Vector3d p = randomIn(random, cube);
        if (solid.inside(p)) samples.push_back(p);
      }
      if (samples.empty()) continue;
      ASSERT_FALSE(points.empty());
      for (int d = 0; d < 40; ++d) {
        const Vector3d direction = randomIn(random, boxAt({0, 0, 0}, Vector3d::Constant(2)));
        const auto reach = [&](const std::vector<Vector3d>& of) {
          double best = -std::numeric_limits<double>::infinity();
          for (const Vector3d& p : of) best = std::max(best, direction.dot(p));
          return best;
        };
        EXPECT_LE(reach(samples), reach(points) + 1e-12);
      }
      for (const Vector3d& p : points) EXPECT_LE(cube.exteriorDistance(p), 1e-12);
    }
  }
}

}  // namespace
}  // namespace spheretree::medial
