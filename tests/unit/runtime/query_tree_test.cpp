// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/query_tree.hpp>

#include <gtest/gtest.h>

#include <functional>

#include "query_trees.hpp"

namespace spheretree {
namespace {

/// All balls of a family, in order.
std::vector<Sphere> ballsOf(const QueryTree& tree, QueryTree::Family family) {
  std::vector<Sphere> balls;
  for (std::uint32_t i = 0; i <= family.further; ++i) {
    const std::uint32_t lanes = i == 0 ? family.lanes : tree.lanes(family.block + i);
    for (std::uint32_t lane = 0; lane < kBlockLanes; ++lane) {
      if ((lanes >> lane & 1U) != 0) balls.push_back(tree.ball(family.block + i, lane));
    }
  }
  return balls;
}

/// Walks both forms of a tree side by side; counts the nodes seen.
void expectSame(const SphereTree& tree, const Node& node, const QueryTree& laid, QueryTree::Family family,
                std::size_t& seen) {
  const std::span<const Node> children = tree.children(node);
  std::vector<Sphere> expected;
  for (const Node& child : children) expected.push_back(child.ball);
  if (expected.empty()) expected.push_back(node.ball);  // a ball without children stands for itself
  ASSERT_EQ(ballsOf(laid, family), expected);
  for (std::size_t i = 0; i < children.size(); ++i) {
    ++seen;
    const auto block = family.block + static_cast<std::uint32_t>(i) / kBlockLanes;
    expectSame(tree, children[i], laid, laid.family(block, static_cast<std::uint32_t>(i) % kBlockLanes),
               seen);
  }
}

TEST(QueryTree, KeepsEveryBallUnderItsParent) {
  test::Random random(7);
  for (const std::uint32_t branch : {1U, 3U, 8U, 9U, 20U}) {
    for (std::uint32_t levels = 1; levels <= 4; ++levels) {
      SCOPED_TRACE("branch " + std::to_string(branch) + ", levels " + std::to_string(levels));
      const SphereTree tree = test::randomTree(random, levels, branch, 4);
      const QueryTree laid = test::queryTreeOf(tree);
      EXPECT_EQ(laid.root(), tree.root().ball);
      EXPECT_EQ(laid.levelCount(), tree.levelCount());
      std::size_t seen = 1;
      expectSame(tree, tree.root(), laid, laid.rootFamily(), seen);
      EXPECT_EQ(seen, tree.nodes().size());
    }
  }
}

TEST(QueryTree, TakesTenThousandBytesForFourLevelsOfEight) {
  EXPECT_EQ(test::latticeTree(4).nodes().size(), 585U);
  EXPECT_LT(test::queryTreeOf(test::latticeTree(4)).bytes(), 10'000U);
}

TEST(QueryTree, StandOffDefaultsToTheDiameter) {
  const QueryTree tree = test::queryTreeOf(test::latticeTree(3));
  EXPECT_NEAR(tree.standOff(0), 2.0F, 1e-5F);
  EXPECT_NEAR(tree.standOff(1), 1.0F, 1e-5F);
  EXPECT_NEAR(tree.standOff(2), 0.5F, 1e-5F);
  EXPECT_EQ(tree.standOff(9), tree.standOff(2));
}

TEST(QueryTree, StandOffIsThatOfTheLevelRoundedUp) {
  const QueryTree tree = test::queryTreeOf(test::latticeTree(3), std::vector<float>{0.5F, 0.75F, 0.125F});
  EXPECT_GE(tree.standOff(0), 0.5F);
  EXPECT_GE(tree.standOff(1), 0.75F);  // a finer level may stick out farther
  EXPECT_GE(tree.standOff(2), 0.125F);
  EXPECT_LT(tree.standOff(2), 0.1251F);
}

TEST(QueryTree, ChildlessBallsCountOnTheLevelsBelow) {
  const SphereTree tree = test::treeOf(
      {{{{0, 0, 0}, 2}, kNoParent}, {{{-1, 0, 0}, 1}, 0}, {{{1, 0, 0}, 1}, 0}, {{{1, 0, 0}, 0.1F}, 1}});
  const QueryTree laid = test::queryTreeOf(tree, std::vector<float>{1, 0.5F, 0.01F});
  EXPECT_GE(laid.standOff(2), 0.5F);
}

TEST(QueryTree, BoundsAreTheTightestLevelBox) {
  const SphereTree tree =
      test::treeOf({{{{0, 0, 0}, 2}, kNoParent}, {{{-1, 0, 0}, 0.5F}, 0}, {{{1, 0, 0}, 0.5F}, 0}});
  const Aabb bounds = test::queryTreeOf(tree).bounds();
  EXPECT_NEAR(bounds.min.x, -1.5F, 1e-4F);
  EXPECT_NEAR(bounds.max.x, 1.5F, 1e-4F);
  EXPECT_NEAR(bounds.max.y, 0.5F, 1e-4F);
  EXPECT_LE(bounds.min.x, -1.5F);
  EXPECT_GE(bounds.max.y, 0.5F);
}

TEST(QueryTree, RefusesWhatItCannotGuarantee) {
  const SphereTree tree = test::latticeTree(2);
  for (const std::vector<float>& standOff :
       {std::vector<float>{1}, std::vector<float>{1, -1}, std::vector<float>{1, NAN}}) {
    const Result<QueryTree> made = QueryTree::create(tree, standOff);
    ASSERT_FALSE(made.ok());
    EXPECT_EQ(made.error().code, ErrorCode::InvalidArgument);
  }
  test::Random random(1);
  EXPECT_TRUE(QueryTree::create(test::randomTree(random, kMaxQueryLevels, 1, 2)).ok());
  EXPECT_FALSE(QueryTree::create(test::randomTree(random, kMaxQueryLevels + 1, 1, 2)).ok());
}

TEST(QueryTree, ReadsStandOffsFromMetadata) {
  const char* text =
      "2 2\n0 0 0 2 1\n-1 0 0 1 1\n1 0 0 1 1\n# mesh-diagonal: 4\n"
      "# level-0: spheres=1 overhang-worst=[0.2,0.25] overhang-mean=0.25\n"
      "# level-1: spheres=2 overhang-worst=[0.1,0.125] overhang-mean=0.1\n";
  const std::vector<float> plain = standOffsOf(parseSph(text).value());
  ASSERT_EQ(plain.size(), 2U);
  EXPECT_GE(plain[0], 1.0F);
  EXPECT_NEAR(plain[0], 1.0F, 1e-4F);
  EXPECT_NEAR(plain[1], 0.5F, 1e-4F);
  const std::vector<float> wrapped =
      standOffsOf(parseSph(std::string(text) + "# wrap-stand-off: 0.01\n").value());
  EXPECT_NEAR(wrapped[1], 0.54F, 1e-4F);
  EXPECT_TRUE(standOffsOf(parseSph("1 1\n0 0 0 2 1\n").value()).empty());
  EXPECT_TRUE(
      standOffsOf(parseSph("1 1\n0 0 0 2 1\n# mesh-diagonal: 4\n# level-0: overhang-worst=[0,x]\n").value())
          .empty());
  // No level is called that.
  for (const std::string key : {"level-", "level-0th", "level--0", "level-99999999999999999999"}) {
    const std::string said = "1 1\n0 0 0 2 1\n# mesh-diagonal: 4\n# " + key + ": overhang-worst=[0,0.1]\n";
    EXPECT_TRUE(standOffsOf(parseSph(said).value()).empty()) << key;
  }
}

}  // namespace
}  // namespace spheretree
