// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/foresight.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/builders/solids.hpp"

namespace spheretree::builders {
namespace {

using medial::Context;
using medial::Surface;

class ForesightOnABar : public testing::Test {
 protected:
  ForesightOnABar() {
    settings_.levels = 4;
    settings_.branch = 4;
    foresight_.spread(piecesOfAll(bar_, 0.4),
                      {.surface = bar_, .effort = sketchEffort(), .context = context_});
    problem_.pieces = piecesOfAll(bar_, 0.3);
  }

  Surface bar_ = boxSurface(8, 1, 1);
  BuildSettings settings_;
  Context context_;
  Foresight foresight_{bar_, settings_, context_};
  LevelProblem problem_;
};

TEST_F(ForesightOnABar, LoadsOfALevelAddUpToTheChildrenItMayHave) {
  for (std::size_t depth = 1; depth <= 2; ++depth) {
    foresight_.weigh(problem_, depth, 1);
    const double sum = std::accumulate(problem_.loads.begin(), problem_.loads.end(), 0.0);
    const double children = std::pow(settings_.branch, static_cast<double>(depth + 1));
    EXPECT_NEAR(sum, children, 0.1 * children) << "level " << depth;
  }
}

TEST_F(ForesightOnABar, HalfABarNeedsHalfTheChildren) {
  foresight_.weigh(problem_, 1, 1);
  double left = 0;
  double all = 0;
  for (std::size_t i = 0; i < problem_.pieces.size(); ++i) {
    all += problem_.loads[i];
    if (problem_.pieces[i].points.front().x() < bar_.bounds().center().x()) left += problem_.loads[i];
  }
  EXPECT_NEAR(left / all, 0.5, 0.1);
}

TEST_F(ForesightOnABar, LeavesHaveNoChildrenToForesee) {
  foresight_.weigh(problem_, 3, 1);
  EXPECT_TRUE(problem_.loads.empty());
}

TEST_F(ForesightOnABar, ALevelWithAnOverloadedBallPromisesLess) {
  std::vector<LevelBall> fair(2);
  for (LevelBall& ball : fair) {
    ball.fit.reach = 1;
    ball.load = settings_.branch;
  }
  std::vector<LevelBall> unfair = fair;
  unfair.front().load = 2 * settings_.branch;
  EXPECT_DOUBLE_EQ(foresight_.prospect(fair, 1), std::log(1.0));
  EXPECT_GT(foresight_.prospect(unfair, 1), foresight_.prospect(fair, 1));
  EXPECT_GT(foresight_.prospect(unfair, 1), foresight_.prospect(unfair, 2)) << "it costs every level below";
}

TEST_F(ForesightOnABar, EvenSetsHaveNoMoreBallsThanTheyMay) {
  const std::vector<std::vector<LevelBall>> sets = foresight_.evenSets({}, 3);
  ASSERT_EQ(sets.size(), 2U) << "without given balls, two of the three have places to start from";
  for (const std::vector<LevelBall>& set : sets) {
    EXPECT_GE(set.size(), 1U);
    EXPECT_LE(set.size(), settings_.branch);
  }
}

TEST_F(ForesightOnABar, WhatStuckOutFartherWeighsMore) {
  foresight_.weigh(problem_, 2, 1);
  const std::vector<double> before = problem_.loads;
  // Two balls above, one at each end of the bar; a child of the left one sticks out twice as far.
  const Eigen::Vector3d middle = bar_.bounds().center();
  std::vector<std::vector<LevelNode>> levels(2, std::vector<LevelNode>(2));
  for (std::uint32_t end = 0; end < 2; ++end) {
    LevelNode& child = levels[1][end];
    child.parent = end;
    child.fit.center.at = middle + Eigen::Vector3d(end == 0 ? -2.0 : 2.0, 0, 0);
    child.fit.reach = 2;
    child.fit.center.depth = end == 0 ? 1.2 : 1.6;
  }
  foresight_.learn(levels);
  foresight_.weigh(problem_, 2, 1);
  double left = 0;
  double leftBefore = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (problem_.pieces[i].points.front().x() > middle.x() - 1) continue;
    left += problem_.loads[i];
    leftBefore += before[i];
  }
  EXPECT_GT(left, 1.2 * leftBefore);
  EXPECT_NEAR(std::accumulate(problem_.loads.begin(), problem_.loads.end(), 0.0),
              std::accumulate(before.begin(), before.end(), 0.0), 1e-9)
      << "there are no more children than before";
  Foresight untaught{bar_, settings_, context_};
  untaught.spread(piecesOfAll(bar_, 0.4), {.surface = bar_, .effort = sketchEffort(), .context = context_});
  untaught.weigh(problem_, 2, 1);
  EXPECT_EQ(problem_.loads, before);
}

TEST(Foresight, ForeseesNothingBeforeLeavesAreSpread) {
  const Surface cube = boxSurface(1, 1, 1);
  const Context context;
  const BuildSettings settings;
  LevelProblem problem;
  problem.pieces = piecesOfAll(cube, 0.5);
  Foresight(cube, settings, context).weigh(problem, 1, 1);
  EXPECT_TRUE(problem.loads.empty());
}

}  // namespace
}  // namespace spheretree::builders
