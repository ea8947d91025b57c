// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/finalize.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "medial/random.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;

Vector3d centerOf(const Sphere& s) {
  return {static_cast<double>(s.center.x), static_cast<double>(s.center.y), static_cast<double>(s.center.z)};
}

TEST(ToSphere, KeepsWhatFloatsCanSay) {
  const Sphere sphere = toSphere({Vector3d(1, -2, 0.5), 0.25});
  EXPECT_EQ(sphere.center, (Vec3{1, -2, 0.5F}));
  EXPECT_LE(sphere.radius, std::nextafter(0.25F, 1.0F));
  EXPECT_GE(sphere.radius, 0.25F);
}

/// Round the centre, grow the radius by the rounding distance, round it up.
TEST(ToSphere, HoldsTheBallAndNotMuchMore) {
  for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    medial::Random random(seed);
    const double size = std::pow(10.0, random.uniform(-9, 9));
    const double offset = random.uniform() < 0.5 ? 0.0 : std::pow(10.0, random.uniform(0, 6));
    medial::Ball ball;
    for (int k = 0; k < 3; ++k) ball.center[k] = size * (random.uniform(-1, 1) + offset);
    ball.radius = size * random.uniform();
    const Sphere sphere = toSphere(ball);
    // long double: 64 bits of mantissa, enough to judge sums of doubles.
    long double moved = 0;
    for (int k = 0; k < 3; ++k) {
      const long double d =
          static_cast<long double>(centerOf(sphere)[k]) - static_cast<long double>(ball.center[k]);
      moved += d * d;
    }
    const long double needed = std::sqrt(moved) + static_cast<long double>(ball.radius);
    ASSERT_GE(static_cast<long double>(sphere.radius), needed);
    const float oneLess = std::nextafter(std::nextafter(sphere.radius, 0.0F), 0.0F);
    ASSERT_LT(static_cast<long double>(oneLess), needed) << "two floats too large";
  }
}

TEST(Finalize, KeepsTheShapeOfTheTree) {
  BallTree tree;
  tree.levels.push_back({{{Vector3d(0, 0, 0), 2}, 0}});
  tree.levels.push_back({{{Vector3d(1, 0, 0), 1}, 0}, {{Vector3d(-1, 0, 0), 1}, 0}});
  tree.levels.push_back(
      {{{Vector3d(1, 0, 0), 0.5}, 0}, {{Vector3d(-1, 1, 0), 0.5}, 1}, {{Vector3d(-1, 0, 0), 0.5}, 1}});
  const Result<SphereTree> made = finalize(tree);
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made->levelCount(), 3U);
  EXPECT_EQ(made->children(made->root()).size(), 2U);
  EXPECT_EQ(made->children(made->level(1)[0]).size(), 1U);
  EXPECT_EQ(made->children(made->level(1)[1]).size(), 2U);
  for (const Node& node : made->nodes()) EXPECT_GT(node.ball.radius, 0.5F) << "a little slack";
}

}  // namespace
}  // namespace spheretree::builders
