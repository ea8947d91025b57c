// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/distance_query.hpp>

#include <gtest/gtest.h>

#include <limits>

#include "query_trees.hpp"

namespace spheretree {
namespace {

Pose at(float x, float y = 0, float z = 0) {
  return {{}, {x, y, z}, 1};
}

TEST(DistanceQuery, OfTwoBalls) {
  // Trees that are their solids: no stand-off.
  const QueryTree ball =
      test::queryTreeOf(test::treeOf({{{{0, 0, 0}, 1}, kNoParent}}), std::vector<float>{0});
  const DistanceBounds apart = distanceBetween(ball, at(5), ball, at(0));
  EXPECT_TRUE(apart.complete);
  EXPECT_NEAR(apart.lower, 3, 1e-3F);
  EXPECT_LE(apart.lower, 3);
  EXPECT_NEAR(apart.upper, 3, 1e-3F);
  EXPECT_GE(apart.upper, 3);
  const DistanceBounds touching = distanceBetween(ball, at(1.5F), ball, at(0));
  EXPECT_EQ(touching.lower, 0);
  EXPECT_NEAR(touching.upper, 0, 1e-3F);
}

TEST(DistanceQuery, ScalesWithThePoses) {
  const QueryTree ball =
      test::queryTreeOf(test::treeOf({{{{1, 0, 0}, 1}, kNoParent}}), std::vector<float>{0});
  Pose large = at(0);
  large.scale = 2;
  large.rotation = {0, 0, 1, 0};  // the ball of radius 2 at x = -2
  const DistanceBounds bounds = distanceBetween(ball, at(4), ball, large);
  EXPECT_NEAR(bounds.lower, 4, 1e-3F);  // the other from 4 to 6
  EXPECT_NEAR(bounds.upper, 4, 1e-3F);
  EXPECT_NEAR(distanceBetween(ball, large, ball, at(4)).lower, 4, 1e-3F);
}

/// The least gap of pairs of chains, by recursion.
float nearest(const SphereTree& a, const Node& x, const Pose& poseA, const SphereTree& b, const Node& y,
              const Pose& poseB, std::uint32_t levelsLeft, float inherited) {
  const Sphere ballA = transform(poseA, x.ball);
  const Sphere ballB = transform(poseB, y.ball);
  const float gap = std::max(inherited, length(ballB.center - ballA.center) - ballA.radius - ballB.radius);
  if (levelsLeft == 0) return gap;
  const std::span<const Node> selfA(&x, 1);
  const std::span<const Node> selfB(&y, 1);
  float least = std::numeric_limits<float>::infinity();
  for (const Node& childA : x.childCount > 0 ? a.children(x) : selfA) {
    for (const Node& childB : y.childCount > 0 ? b.children(y) : selfB) {
      least = std::min(least, nearest(a, childA, poseA, b, childB, poseB, levelsLeft - 1, gap));
    }
  }
  return least;
}

TEST(DistanceQuery, FindsTheLeastGapOfChains) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const SphereTree a = test::randomTree(random, 3, 9, 6);
    const SphereTree b = test::randomTree(random, 2 + random.below(2), 6, 6);
    const Pose poseA = random.pose(4);
    const Pose poseB = random.pose(1);
    const auto levels = static_cast<std::uint32_t>(std::max(a.levelCount(), b.levelCount()) - 1);
    const float expected = std::max(0.0F, nearest(a, a.root(), poseA, b, b.root(), poseB, levels, -1));
    const QueryTree laidA = test::queryTreeOf(a);
    const QueryTree laidB = test::queryTreeOf(b);
    const DistanceBounds bounds = distanceBetween(laidA, poseA, laidB, poseB);
    ASSERT_TRUE(bounds.complete);
    EXPECT_NEAR(bounds.lower, expected, 1e-3F);
    EXPECT_LE(bounds.upper, bounds.lower + laidA.standOff(9) + laidB.standOff(9) + 1e-3F);
    float lower = 0;
    float upper = std::numeric_limits<float>::infinity();
    for (std::uint64_t budget = 0; budget < 4000; budget += 64) {
      const DistanceBounds limited = distanceBetween(laidA, poseA, laidB, poseB, {.sphereTests = budget});
      EXPECT_GE(limited.lower, lower);
      EXPECT_LE(limited.upper, upper);
      EXPECT_LE(limited.lower, bounds.lower);
      lower = limited.lower;
      upper = limited.upper;
    }
  }
}

TEST(DistanceQuery, ChildrenOutsideTheirParentsCountWithTheirOwnStandOff) {
  // The solid is a small ball at the origin; a child of its root sticks out by 4 towards the other body.
  const SphereTree tree = test::treeOf({{{{0, 0, 0}, 0.1F}, kNoParent}, {{{2, 0, 0}, 2.1F}, 0}});
  const QueryTree laid = test::queryTreeOf(tree, std::vector<float>{0, 4});
  const QueryTree ball =
      test::queryTreeOf(test::treeOf({{{{0, 0, 0}, 1}, kNoParent}}), std::vector<float>{0});
  const DistanceBounds bounds = distanceBetween(laid, at(0), ball, at(10));
  EXPECT_NEAR(bounds.lower, 8.9F, 1e-2F);  // the chain ends in the child, but begins in the root
  EXPECT_NEAR(bounds.upper, 8.9F, 1e-2F);
  EXPECT_GE(bounds.upper, 8.9F);
}

TEST(DistanceQuery, AgreesWithThePairQuery) {
  test::Random random(5);
  const QueryTree tree = test::queryTreeOf(test::randomTree(random, 4, 8, 9));
  PairQuery query(tree, tree);
  for (int i = 0; i < 200; ++i) {
    const Pose a = random.pose(1.5F);
    const Pose b = random.pose(1);
    query.restart(a, b);
    const DistanceBounds bounds = distanceBetween(tree, a, tree, b);
    if (query.advance() == Answer::Overlapping) {
      EXPECT_LE(bounds.lower, 1e-3F);
      EXPECT_LE(bounds.upper, query.slackBound() + 1e-3F);
    } else {
      EXPECT_GE(bounds.lower, 0);
    }
  }
}

}  // namespace
}  // namespace spheretree
