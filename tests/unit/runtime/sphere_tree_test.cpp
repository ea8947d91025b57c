// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/sphere_tree.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace spheretree {
namespace {

using Entry = SphereTree::Entry;

constexpr Sphere kUnitBall{{0, 0, 0}, 1};

/// A ball that can be told from the others.
Sphere ball(float x) {
  return {{x, 0, 0}, 1};
}

std::string refusalOf(std::vector<Entry> entries) {
  const Result<SphereTree> tree = SphereTree::create(entries);
  if (tree) return "accepted";
  EXPECT_EQ(tree.error().code, ErrorCode::InvalidArgument);
  return tree.error().message;
}

/// A root with children 1 and 2; 1 is a leaf, 2 has children 3, 4, 5; 4 has child 6.
std::vector<Entry> lopsidedEntries() {
  return {{ball(0), kNoParent}, {ball(1), 0}, {ball(2), 0}, {ball(3), 2},
          {ball(4), 2},         {ball(5), 2}, {ball(6), 4}};
}

TEST(SphereTree, OneBallIsATreeOfOneLevel) {
  const Result<SphereTree> tree = SphereTree::create(std::vector<Entry>{{kUnitBall, kNoParent}});
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->levelCount(), 1U);
  EXPECT_EQ(tree->level(0).size(), 1U);
  EXPECT_EQ(tree->root().ball, kUnitBall);
  EXPECT_EQ(tree->root().parent, kNoParent);
  EXPECT_TRUE(tree->children(tree->root()).empty());
  EXPECT_EQ(tree->maxChildren(), 0U);
}

TEST(SphereTree, LevelsAreRunsAndLeavesMayBeAnywhere) {
  const Result<SphereTree> tree = SphereTree::create(lopsidedEntries());
  ASSERT_TRUE(tree);
  ASSERT_EQ(tree->levelCount(), 4U);
  const std::vector<std::vector<float>> expected{{0}, {1, 2}, {3, 4, 5}, {6}};
  for (std::size_t depth = 0; depth < 4; ++depth) {
    std::vector<float> found;
    for (const Node& node : tree->level(depth)) found.push_back(node.ball.center.x);
    EXPECT_EQ(found, expected[depth]) << "depth " << depth;
  }
  EXPECT_EQ(tree->maxChildren(), 3U);
}

TEST(SphereTree, ChildrenAndParentsAgree) {
  const Result<SphereTree> tree = SphereTree::create(lopsidedEntries());
  ASSERT_TRUE(tree);
  const auto nodes = tree->nodes();
  std::size_t children = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const Node& child : tree->children(nodes[i])) EXPECT_EQ(child.parent, i);
    children += tree->children(nodes[i]).size();
  }
  EXPECT_EQ(children, nodes.size() - 1);
  EXPECT_TRUE(tree->children(nodes[1]).empty());
  ASSERT_EQ(tree->children(nodes[2]).size(), 3U);
  EXPECT_EQ(tree->children(nodes[2]).front().ball, ball(3));
}

TEST(SphereTree, AChainHasAsManyLevelsAsBalls) {
  std::vector<Entry> entries{{ball(0), kNoParent}};
  for (std::uint32_t i = 0; i < 99; ++i) entries.push_back({ball(1), i});
  const Result<SphereTree> tree = SphereTree::create(entries);
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->levelCount(), 100U);
  EXPECT_EQ(tree->maxChildren(), 1U);
}

TEST(SphereTree, NegativeZeroRadiusBecomesZero) {
  const Result<SphereTree> tree = SphereTree::create(std::vector<Entry>{{{{1, 0, 0}, -0.0F}, kNoParent}});
  ASSERT_TRUE(tree);
  EXPECT_FALSE(std::signbit(tree->root().ball.radius));
}

TEST(SphereTree, RefusesAnEmptyList) {
  EXPECT_EQ(refusalOf({}), "a sphere tree needs at least a root");
}

TEST(SphereTree, RefusesABrokenOrderAndNamesTheEntry) {
  EXPECT_EQ(refusalOf({{ball(0), 0}}), "entry 0: the first entry must be the root");
  EXPECT_EQ(refusalOf({{ball(0), kNoParent}, {ball(1), kNoParent}}),
            "entry 1: only the first entry may be a root");
  EXPECT_EQ(refusalOf({{ball(0), kNoParent}, {ball(1), 0}, {ball(2), 2}}),
            "entry 2: a parent must come before its children");
  EXPECT_EQ(refusalOf({{ball(0), kNoParent}, {ball(1), 3}, {ball(2), 0}}),
            "entry 1: a parent must come before its children");
  EXPECT_EQ(refusalOf({{ball(0), kNoParent}, {ball(1), 0}, {ball(2), 1}, {ball(3), 0}}),
            "entry 3: siblings must stand side by side, in the order of their parents");
}

TEST(SphereTree, RefusesImpossibleBallsAndNamesTheEntry) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const Sphere& broken :
       {Sphere{{kNan, 0, 0}, 1}, Sphere{{0, kInfinity, 0}, 1}, Sphere{{0, 0, -kInfinity}, 1},
        Sphere{{0, 0, 0}, kNan}, Sphere{{0, 0, 0}, kInfinity}}) {
    EXPECT_EQ(refusalOf({{kUnitBall, kNoParent}, {broken, 0}}),
              "entry 1: the centre or the radius is not a finite number");
  }
  EXPECT_EQ(refusalOf({{kUnitBall, kNoParent}, {{{0, 0, 0}, -1}, 0}}), "entry 1: the radius is negative");
}

}  // namespace
}  // namespace spheretree
