// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/cell_set.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "medial/random.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

TEST(Bisect, CutsTheLongestEdgeInTheMiddle) {
  const SurfaceCell cell{Vector3d(0, 0, 0), Vector3d(4, 0, 0), Vector3d(1, 1, 0)};
  const auto [left, right] = bisect(cell);
  EXPECT_EQ(left, (SurfaceCell{Vector3d(0, 0, 0), Vector3d(2, 0, 0), Vector3d(1, 1, 0)}));
  EXPECT_EQ(right, (SurfaceCell{Vector3d(2, 0, 0), Vector3d(4, 0, 0), Vector3d(1, 1, 0)}));
}

TEST(Bisect, KeepsAreaAndOrientation) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    SurfaceCell cell;
    for (Vector3d& p : cell) p = {random.uniform(), random.uniform(), random.uniform()};
    const auto [a, b] = bisect(cell);
    EXPECT_NEAR(areaOf(a), areaOf(cell) / 2, 1e-12);
    EXPECT_NEAR(areaOf(b), areaOf(cell) / 2, 1e-12);
    const Vector3d normal = (cell[1] - cell[0]).cross(cell[2] - cell[0]);
    EXPECT_GT((a[1] - a[0]).cross(a[2] - a[0]).dot(normal), 0);
    EXPECT_GT((b[1] - b[0]).cross(b[2] - b[0]).dot(normal), 0);
  }
}

TEST(Bisect, NeighboursAgreeOnTheMidpointOfTheirEdge) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vector3d a(random.uniform(), random.uniform(), random.uniform());
    const Vector3d b = a + Vector3d(3, random.uniform(), 0);
    const auto [one, unused] = bisect({a, b, a + Vector3d(1, 1, 0)});
    const auto [other, unused2] = bisect({b, a, a + Vector3d(1, -1, 0)});
    EXPECT_EQ(one[1], other[1]);
  }
}

// Splitting a needle into four similar ones would take 100^2 pieces or more.
TEST(Bisect, ThinTrianglesNeedFarFewerPiecesThanTheSquareOfTheirLength) {
  std::vector<SurfaceCell> open{{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0.5, 1e-9, 0)}};
  std::size_t pieces = 0;
  while (!open.empty()) {
    const SurfaceCell cell = open.back();
    open.pop_back();
    if (longestEdge(cell) <= 0.01) {
      ++pieces;
      continue;
    }
    const auto [a, b] = bisect(cell);
    open.push_back(a);
    open.push_back(b);
  }
  EXPECT_LE(pieces, 2000U);
}

TEST(CellSet, SharesCorners) {
  const std::vector<SurfaceCell> square{{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(1, 1, 0)},
                                        {Vector3d(0, 0, 0), Vector3d(1, 1, 0), Vector3d(0, 1, 0)}};
  const SolidCell solid{Eigen::AlignedBox3d(Vector3d(0, 0, 0), Vector3d(1, 1, 1)),
                        {Vector3d(0, 0, 0), Vector3d(0, 0, 1), Vector3d(0, 1, 1), Vector3d(1, 1, 1)}};
  const CellSet set(square, std::vector<SolidCell>{solid});
  EXPECT_EQ(set.size(), 3U);
  EXPECT_EQ(set.points().size(), 7U) << "four of the square, of which the solid cell uses one";
  EXPECT_EQ(set.corners(0).size(), 3U);
  EXPECT_EQ(set.corners(2).size(), 4U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(set.points()[set.corners(1)[k]], square[1][k]);
  EXPECT_DOUBLE_EQ(set.farthestSquared(0, Vector3d(0, 0, 0)), 2);
  EXPECT_DOUBLE_EQ(set.farthestSquared(2, Vector3d(0, 0, 0)), 3);
}

}  // namespace
}  // namespace spheretree::medial
