// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/min_ball.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "medial/random.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

double farthest(const std::vector<Vector3d>& points, const Vector3d& center) {
  double most = 0;
  for (const Vector3d& p : points) most = std::max(most, (p - center).norm());
  return most;
}

TEST(MinBall, OfFewPointsIsKnown) {
  EXPECT_EQ(minBall({}).radius, 0);
  const std::vector<Vector3d> one{{3, 4, 5}};
  EXPECT_EQ(minBall(one).radius, 0);
  EXPECT_EQ(minBall(one).center, one[0]);
  const std::vector<Vector3d> two{{0, 0, 0}, {2, 0, 0}};
  EXPECT_DOUBLE_EQ(minBall(two).radius, 1);
  const std::vector<Vector3d> equilateral{{1, 0, 0}, {-0.5, std::sqrt(0.75), 0}, {-0.5, -std::sqrt(0.75), 0}};
  EXPECT_NEAR(minBall(equilateral).radius, 1, 1e-15);
  const std::vector<Vector3d> obtuse{{-1, 0, 0}, {1, 0, 0}, {0, 0.3, 0}};
  EXPECT_NEAR(minBall(obtuse).radius, 1, 1e-15) << "the two far points decide alone";
  const std::vector<Vector3d> tetrahedron{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  EXPECT_NEAR(minBall(tetrahedron).radius, std::sqrt(3.0), 1e-15);
}

TEST(MinBall, OfDegenerateSetsIsKnown) {
  const std::vector<Vector3d> same(50, Vector3d(1, 2, 3));
  EXPECT_EQ(minBall(same).radius, 0);
  std::vector<Vector3d> line;
  for (int i = 0; i <= 100; ++i) line.emplace_back(0.1 * i, 0.2 * i, -0.3 * i);
  EXPECT_NEAR(minBall(line).radius, std::sqrt(0.14) * 50, 1e-12);
  std::vector<Vector3d> cospherical;
  for (int i = 0; i < 8; ++i) cospherical.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  EXPECT_NEAR(minBall(cospherical).radius, std::sqrt(3.0), 1e-15);
  std::vector<Vector3d> circle;
  for (int i = 0; i < 1000; ++i) circle.emplace_back(std::cos(0.1 * i), std::sin(0.1 * i), 0);
  EXPECT_NEAR(minBall(circle).radius, 1, 1e-12);
  EXPECT_LT(minBall(circle).center.norm(), 1e-6);
}

/// Smallest is certified by duality: the centre lies in the hull of the points on the boundary, which holds
/// exactly when no direction takes the centre closer to all of them at once.
TEST(MinBall, IsEnclosingAndCannotShrink) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::vector<Vector3d> points;
    const auto count = 2 + random.next() % 300;
    const Vector3d stretch(random.uniform(0.01, 1), random.uniform(0.01, 1), 1);
    for (std::uint64_t i = 0; i < count; ++i) {
      const Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      points.emplace_back(p.cwiseProduct(stretch));
    }
    const Ball ball = minBall(points);
    ASSERT_LE(farthest(points, ball.center), ball.radius * (1 + 1e-15));
    for (int i = 0; i < 200; ++i) {
      Vector3d direction(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      direction *= 1e-4 * random.uniform() * ball.radius;
      ASSERT_GE(farthest(points, ball.center + direction), ball.radius * (1 - 1e-12));
    }
  }
}

}  // namespace
}  // namespace spheretree::medial
