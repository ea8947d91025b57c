// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/ancestry.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using Levels = std::vector<std::vector<LevelNode>>;

/// A ball whose centre lies `depth` inside the solid.
LevelNode nodeAt(double x, double depth, double reach, std::uint32_t parent = 0) {
  LevelNode node;
  node.fit.center.at = {x, 0, 0};
  node.fit.center.depth = depth;
  node.fit.reach = reach;
  node.parent = parent;
  return node;
}

Piece pointAt(double x) {
  Piece piece;
  piece.points = {Vector3d(x, 0, 0)};
  return piece;
}

using Numbers = std::vector<std::uint32_t>;

// Two balls in a row: the right one sticks out by 0.5, the left one by nothing.
const Levels kTwo{{nodeAt(0, 1, 5)}, {nodeAt(-1, 1, 1), nodeAt(1, 0.5, 1)}};

TEST(Ancestry, TheRootAloneHoldsEverything) {
  const Ancestry root(std::vector<std::vector<LevelNode>>{{nodeAt(0, 1, 5)}}, Objective::Worst);
  EXPECT_EQ(root.holders(pointAt(100)), Numbers{0});
}

TEST(Ancestry, WhereTheWorstCountsBallsGrowAsFarAsItDoes) {
  const Ancestry ancestry(kTwo, Objective::Worst);
  EXPECT_EQ(ancestry.holders(pointAt(-2)), Numbers{0});
  EXPECT_EQ(ancestry.holders(pointAt(0.25)), (Numbers{0, 1}));  // 1.25 from the left one, which grows to 1.5
  EXPECT_EQ(ancestry.holders(pointAt(0.75)), Numbers{1});
  EXPECT_EQ(ancestry.holders(pointAt(2.25)), Numbers{});  // the worst one does not grow
}

TEST(Ancestry, OtherwiseBallsAreWhatTheyAre) {
  const Ancestry ancestry(kTwo, Objective::Mean);
  EXPECT_EQ(ancestry.holders(pointAt(0.25)), Numbers{1});
  EXPECT_EQ(ancestry.holders(pointAt(0)), (Numbers{0, 1}));
}

TEST(Ancestry, APieceIsHeldWholeOrNotAtAll) {
  Piece longPiece = pointAt(-0.5);
  longPiece.points.push_back(Vector3d(1.5, 0, 0));
  EXPECT_EQ(Ancestry(kTwo, Objective::Worst).holders(longPiece), Numbers{});
}

TEST(Ancestry, WhatAnAncestorDoesNotHoldItsChildrenMayNotHave) {
  Levels three = kTwo;
  three.push_back({nodeAt(0.75, 1, 1, 0), nodeAt(0.75, 1, 1, 1)});  // the same ball below either
  const Ancestry ancestry(three, Objective::Mean);
  EXPECT_EQ(ancestry.holders(pointAt(1)), Numbers{1});
}

}  // namespace
}  // namespace spheretree::builders
