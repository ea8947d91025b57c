// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/delaunay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <vector>

#include "medial/near_points.hpp"
#include "medial/random.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> randomPoints(std::size_t count, std::uint64_t seed) {
  Random random(seed, 0);
  std::vector<Vector3d> points(count);
  for (Vector3d& p : points) p = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
  return points;
}

/// Every unit cube has eight cospherical corners.
std::vector<Vector3d> gridPoints(int n) {
  std::vector<Vector3d> points;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) points.emplace_back(x, y, z);
  return points;
}

std::set<Delaunay::Corners> tetrahedraOf(const Delaunay& delaunay) {
  std::set<Delaunay::Corners> found;
  for (std::uint32_t i = 0; i < delaunay.size(); ++i) {
    if (!delaunay.alive(i)) continue;
    Delaunay::Corners corners = delaunay.corners(i);
    std::sort(corners.begin(), corners.end());
    found.insert(corners);
  }
  return found;
}

TEST(Delaunay, GrowsIntoWhatItWouldHaveBeenAtOnce) {
  for (const std::vector<Vector3d>& points : {randomPoints(200, 1), randomPoints(60, 2), gridPoints(5)}) {
    const Delaunay atOnce(points);
    // The first points of the grid are in a plane: there are no tetrahedra yet.
    const std::size_t start = points.size() / 5;
    const std::span<const Vector3d> all(points);
    Delaunay grown(all.first(start));
    for (std::size_t i = start; i < points.size(); ++i) {
      const Delaunay::Change change = grown.insert(points[i], static_cast<std::uint32_t>(i), Delaunay::kNone);
      for (const std::uint32_t tetrahedron : change.removed) EXPECT_FALSE(grown.alive(tetrahedron));
      for (const std::uint32_t tetrahedron : change.created) EXPECT_TRUE(grown.alive(tetrahedron));
    }
    EXPECT_EQ(tetrahedraOf(grown), tetrahedraOf(atOnce));
  }
}

TEST(Delaunay, IgnoresAPointThatIsThere) {
  const std::vector<Vector3d> points = gridPoints(3);
  Delaunay delaunay(points);
  const auto before = tetrahedraOf(delaunay);
  for (std::uint32_t near : {Delaunay::kNone, 0U}) {
    const Delaunay::Change change = delaunay.insert(points[13], 99, near);
    EXPECT_TRUE(change.created.empty());
    EXPECT_TRUE(change.removed.empty());
  }
  EXPECT_EQ(tetrahedraOf(delaunay), before);
}

TEST(Delaunay, BallsHoldNoOtherPointAndFacetsHaveTwoSides) {
  const std::vector<Vector3d> points = randomPoints(150, 3);
  const Delaunay delaunay(points);
  std::size_t hull = 0;
  for (std::uint32_t i = 0; i < delaunay.size(); ++i) {
    const Delaunay::Corners& c = delaunay.corners(i);
    const auto ball = circumscribedBall({points[c[0]], points[c[1]], points[c[2]], points[c[3]]});
    if (!ball) continue;
    for (const Vector3d& p : points) EXPECT_GE((p - ball->center).norm(), ball->radius * (1 - 1e-6));
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t other = delaunay.neighbour(i, k);
      if (other == Delaunay::kNone) {
        ++hull;
        continue;
      }
      std::size_t back = 0;
      for (std::size_t m = 0; m < 4; ++m) back += delaunay.neighbour(other, m) == i ? 1U : 0U;
      EXPECT_EQ(back, 1U);
    }
  }
  EXPECT_GT(hull, 3U);
}

TEST(CircumscribedBall, OfARightCornerAndOfASliver) {
  const auto ball = circumscribedBall({Vector3d(0, 0, 0), {2, 0, 0}, {0, 2, 0}, {0, 0, 2}});
  ASSERT_TRUE(ball.has_value());
  EXPECT_LT((ball->center - Vector3d(1, 1, 1)).norm(), 1e-15);
  EXPECT_NEAR(ball->radius, std::sqrt(3.0), 1e-15);
  EXPECT_FALSE(circumscribedBall({Vector3d(0, 0, 0), {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}).has_value());
}

TEST(NearPoints, AgreesWithLookingAtEach) {
  for (const std::size_t count : {0U, 1U, 7U, 9U, 33U, 500U}) {
    const std::vector<Vector3d> points = randomPoints(count, 4);
    const NearPoints near(points);
    Random random(5, count);
    std::size_t last = 0;
    for (int n = 0; n < 500; ++n) {
      const Vector3d place{random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5), random.uniform(-0.5, 1.5)};
      const double distance = random.uniform(0, 0.4);
      const bool expected = std::any_of(points.begin(), points.end(), [&](const Vector3d& p) {
        return (p - place).squaredNorm() <= distance * distance;
      });
      ASSERT_EQ(near.anyWithin(place, distance, last), expected);
      if (expected) {
        ASSERT_LE((points[last] - place).norm(), distance);
      }
    }
  }
}

}  // namespace
}  // namespace spheretree::medial
