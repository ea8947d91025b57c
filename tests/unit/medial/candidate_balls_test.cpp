// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/candidate_balls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "medial/random.hpp"
#include "models/shapes.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

constexpr double kStep = 1e-9;

Vector3d somewhere(Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

std::vector<MedialBall> someBalls(Random& random, std::size_t count) {
  std::vector<MedialBall> balls(count);
  for (MedialBall& ball : balls) {
    ball.depth = random.uniform(0, 0.5);
    ball.ball = {somewhere(random), ball.depth};
  }
  return balls;
}

TEST(ThinOut, KeepsABallThatIsAsGoodForEachPlace) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 0);
    const std::vector<MedialBall> balls = someBalls(random, 300);
    constexpr double kTolerance = 0.1;
    const auto standIn = thinOut(balls, kTolerance, kStep, balls.size());
    ASSERT_TRUE(standIn.has_value());
    std::size_t kept = 0;
    for (std::uint32_t i = 0; i < balls.size(); ++i) {
      const std::uint32_t k = (*standIn)[i];
      EXPECT_EQ((*standIn)[k], k);
      kept += k == i ? 1U : 0U;
      for (int n = 0; n < 20; ++n) {
        const Vector3d place = 2 * somewhere(random);
        const double own = (place - balls[i].ball.center).norm() - balls[i].depth;
        const double other = (place - balls[k].ball.center).norm() - balls[k].depth;
        EXPECT_LE(other, own + kTolerance + 1e-12);
      }
    }
    EXPECT_LT(kept, balls.size());
    EXPECT_TRUE(thinOut(balls, kTolerance, kStep, kept).has_value());
    EXPECT_FALSE(thinOut(balls, kTolerance, kStep, kept - 1).has_value());
  }
}

TEST(ThinOut, DropsABallInsideAnotherOnly) {
  const std::vector<MedialBall> balls{
      {{{0, 0, 0}, 1}, 1}, {{{0.5, 0, 0}, 0.4}, 0.4}, {{{0.7, 0, 0}, 0.4}, 0.4}};
  const auto standIn = thinOut(balls, 0, kStep, 3);
  ASSERT_TRUE(standIn.has_value());
  EXPECT_EQ(*standIn, (std::vector<std::uint32_t>{0, 0, 2}));
}

TEST(GapBalls, CloseWhatNobodyReaches) {
  // One ball in the middle of a long bar: its ends lie far outside.
  const auto bar = Surface::create(models::makeBox({10, 1, 1}));
  ASSERT_TRUE(bar.ok());
  std::vector<SurfaceCell> cells;
  for (std::size_t t = 0; t < bar->mesh().triangles.size(); ++t) {
    std::vector<SurfaceCell> todo{
        {bar->mesh().corner(t, 0), bar->mesh().corner(t, 1), bar->mesh().corner(t, 2)}};
    while (!todo.empty()) {
      const SurfaceCell cell = todo.back();
      todo.pop_back();
      if (longestEdge(cell) <= 0.3) {
        cells.push_back(cell);
        continue;
      }
      const auto [first, second] = bisect(cell);
      todo.insert(todo.end(), {first, second});
    }
  }
  const CellSet set(cells, {});
  std::vector<MedialBall> balls{{{{0, 0, 0}, 0.5}, 0.5}};
  const auto added = gapBalls(*bar, set, balls, 0.25, set.size(), Context(1));
  ASSERT_TRUE(added.has_value());
  EXPECT_FALSE(gapBalls(*bar, set, balls, 0.25, added->size() - 1, Context(1)).has_value());
  for (const MedialBall& ball : *added) {
    EXPECT_GT(ball.depth, 0);
    EXPECT_NEAR(bar->depth(ball.ball.center), ball.depth, 1e-12);
  }
  balls.insert(balls.end(), added->begin(), added->end());
  for (std::size_t cell = 0; cell < set.size(); ++cell) {
    EXPECT_TRUE(std::any_of(balls.begin(), balls.end(), [&](const MedialBall& ball) {
      return std::sqrt(set.farthestSquared(cell, ball.ball.center)) <= ball.depth + 0.25;
    }));
  }
  EXPECT_TRUE(gapBalls(*bar, set, balls, 0.25, 0, Context(1))->empty()) << "there are no gaps left";
}

TEST(LinkNearest, LinksABallWithThoseNearIt) {
  std::vector<MedialBall> balls;
  for (int i = 0; i < 10; ++i) balls.push_back({{{static_cast<double>(i), 0, 0}, 1}, 1});
  const auto links = linkNearest(balls, 9, kStep);
  EXPECT_EQ(links, (std::vector<std::array<std::uint32_t, 2>>{{8, 9}, {7, 9}, {6, 9}}));
  EXPECT_TRUE(linkNearest(balls, balls.size(), kStep).empty());
  EXPECT_EQ(linkNearest(std::span(balls).first(2), 0, kStep),
            (std::vector<std::array<std::uint32_t, 2>>{{0, 1}, {0, 1}}));
}

}  // namespace
}  // namespace spheretree::medial
