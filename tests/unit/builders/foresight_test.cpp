// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/foresight.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "builders/region.hpp"
#include "tests/unit/builders/solids.hpp"

namespace spheretree::builders {
namespace {

using medial::Context;
using medial::Surface;

std::vector<Piece> piecesOfAll(const Surface& surface, double size) {
  Region region;
  for (std::uint32_t t = 0; t < surface.mesh().triangles.size(); ++t) {
    region.surface.push_back(
        {surface.mesh().corner(t, 0), surface.mesh().corner(t, 1), surface.mesh().corner(t, 2)});
  }
  return piecesOf(surface, region, {size, size});
}

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
