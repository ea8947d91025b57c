// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/refine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "builders/corner_index.hpp"
#include "builders/fit_ball.hpp"
#include "builders/patch.hpp"
#include "builders/pieces.hpp"
#include "medial/random.hpp"
#include "models/shapes.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::Surface;
using medial::SurfaceCell;

Surface solid(medial::TriangleMesh mesh) {
  auto surface = Surface::create(std::move(mesh));
  EXPECT_TRUE(surface) << (surface ? "" : surface.error().message);
  return std::move(*surface);
}

std::vector<SurfaceCell> cellsOf(const Surface& surface) {
  std::vector<SurfaceCell> cells;
  for (std::uint32_t t = 0; t < surface.mesh().triangles.size(); ++t) {
    cells.push_back({surface.mesh().corner(t, 0), surface.mesh().corner(t, 1), surface.mesh().corner(t, 2)});
  }
  return cells;
}

PointBlock cornersOf(const Surface& surface) {
  PointBlock points;
  for (const SurfaceCell& cell : cellsOf(surface)) {
    for (const Vector3d& p : cell) points.push(p);
  }
  return points;
}

// Five levels of the bunny crashed: a ball was moved whose pieces no other parent nearby might have.
TEST(Patch, SaysWhenThePiecesOfABallThatMovesAwayFindNobody) {
  const Surface bar = solid(models::makeBox({2, 1, 1}));
  const double middle = bar.bounds().center().x();
  const medial::Context context;
  for (const bool shared : {false, true}) {
    SCOPED_TRACE(shared);
    LevelProblem problem;
    problem.parents = 2;
    problem.pieces = surfacePieces(cellsOf(bar), 0.6);
    std::vector<LevelBall> level(2);
    for (std::uint32_t i = 0; i < problem.pieces.size(); ++i) {
      const std::uint32_t side = problem.pieces[i].points.front().x() < middle ? 0 : 1;
      problem.allowed.push_back(shared ? std::vector<std::uint32_t>{0, 1} : std::vector<std::uint32_t>{side});
      level[side].pieces.push_back(i);
    }
    for (std::uint32_t side = 0; side < 2; ++side) {
      level[side].parent = side;
      level[side].fit = {probeDepth(bar, bar.bounds().center() + Vector3d(side == 0 ? -0.5 : 0.5, 0, 0)),
                         1.2};
    }
    const RefineRequest request{.surface = bar, .effort = {}, .context = context};
    const std::vector<std::uint32_t> members{0, 1};
    Patch patch(request, problem, CornerIndex(problem.pieces), level, members, BallCost());
    EXPECT_EQ(patch.move(0, 1, 1, 0, FitEffort()), shared);
  }
}

TEST(FitBall, OneBallAroundACubeSitsInItsMiddle) {
  // max |p - c| - depth(c) of a cube with edge 2 is least in the middle: sqrt(3) - 1.
  const Surface cube = solid(models::makeBox({2, 2, 2}));
  const Vector3d middle = cube.bounds().center();
  const DepthProbe start = probeDepth(cube, middle + Vector3d(0.3, -0.2, 0.4));
  const Fit fit = fitBall(cube, cornersOf(cube), start, {60, 1e-9});
  EXPECT_NEAR(fit.standOff(), std::sqrt(3.0) - 1, 1e-3);
  EXPECT_NEAR((fit.center.at - middle).norm(), 0, 2e-2);
}

TEST(FitBall, IsNeverWorseThanItsStartAndNearTheBestOfManyPlaces) {
  const Surface shape = solid(models::makeKnot(96, 12));
  const std::vector<SurfaceCell> cells = cellsOf(shape);
  medial::Random random(7, 1);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    const Vector3d near =
        cells[static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(cells.size() - 1))][0];
    PointBlock points;
    for (const SurfaceCell& cell : cells) {
      if ((cell[0] - near).norm() > 0.1 * shape.diagonal()) continue;
      for (const Vector3d& p : cell) points.push(p);
    }
    const DepthProbe start = probeDepth(shape, near);
    const double before = std::sqrt(farthestSquared(points, near)) - start.depth;
    const Fit fit = fitBall(shape, points, start, {40, 1e-6});
    EXPECT_LE(fit.standOff(), before);
    EXPECT_NEAR(fit.reach, std::sqrt(farthestSquared(points, fit.center.at)), 1e-12);
    EXPECT_NEAR(fit.center.depth, shape.depth(fit.center.at), 1e-12);
    double around = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 300; ++i) {
      const Vector3d step(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      const Vector3d c = fit.center.at + 0.02 * fit.reach * step;
      around = std::min(around, std::sqrt(farthestSquared(points, c)) - shape.depth(c));
    }
    // A local minimum: nothing near by is better by more than a per cent of the reach.
    EXPECT_GT(around, fit.standOff() - 0.01 * fit.reach);
  }
}

TEST(Pieces, KeepTheAreaWhateverTheirSize) {
  const Surface shape = solid(models::makeKnot(96, 12));
  const std::vector<SurfaceCell> cells = cellsOf(shape);
  for (const double size : {2.0, 0.3, 0.02}) {
    SCOPED_TRACE(size);
    const double limit = size * shape.diagonal();
    const std::vector<Piece> pieces = surfacePieces(cells, limit);
    double area = 0;
    for (const Piece& piece : pieces) {
      area += areaOf(piece);
      EXPECT_LE(piece.size(), limit * (1 + 1e-12));
    }
    EXPECT_NEAR(area, shape.area(), 1e-9 * shape.area());
  }
}

TEST(Pieces, CutsAreHalvesOfTheWhole) {
  const Surface cube = solid(models::makeBox({1, 1, 1}));
  std::vector<Piece> pieces{pieceOf(cellsOf(cube))};
  double least = 0;
  for (int i = 0; i < 40; ++i) {
    auto [first, second] = cut(pieces[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(areaOf(first) + areaOf(second), areaOf(pieces[static_cast<std::size_t>(i)]), 1e-12);
    EXPECT_GT(areaOf(first), least);
    EXPECT_GT(areaOf(second), least);
    pieces.push_back(std::move(first));
    pieces.push_back(std::move(second));
  }
}

/// Balls in the corners of a box around the solid: a poor start that leaves everything to the refinement.
std::vector<LevelBall> poorStart(const Surface& surface, std::size_t count) {
  std::vector<LevelBall> balls;
  medial::Random random(3, 5);
  for (std::size_t i = 0; i < count; ++i) {
    LevelBall ball;
    const Vector3d t(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
    ball.fit.center = probeDepth(surface, surface.bounds().min() + t.cwiseProduct(surface.bounds().sizes()));
    balls.push_back(ball);
  }
  return balls;
}

struct Level {
  LevelProblem problem;
  std::vector<LevelBall> balls;
};

Level refined(const Surface& surface, std::size_t count, unsigned threads, double goodEnough = 0) {
  Level level;
  level.problem.pieces = surfacePieces(cellsOf(surface), 0.1 * surface.diagonal());
  level.problem.allowed.assign(level.problem.pieces.size(), {0});
  level.problem.branch = static_cast<std::uint32_t>(count);
  const medial::Context context(threads);
  level.balls =
      refineLevel(level.problem, poorStart(surface, count),
                  {surface, Objective::Worst, goodEnough, refineEffort(Quality::Normal), 1, context});
  return level;
}

double worstOf(const std::vector<LevelBall>& balls) {
  double worst = 0;
  for (const LevelBall& ball : balls) worst = std::max(worst, ball.fit.standOff());
  return worst;
}

TEST(Refine, EveryPieceEndsInOneBallThatHoldsIt) {
  const Surface shape = solid(models::makeKnot(96, 12));
  const Level level = refined(shape, 12, 1);
  std::vector<int> owners(level.problem.pieces.size(), 0);
  EXPECT_LE(level.balls.size(), 12U);
  for (const LevelBall& ball : level.balls) {
    for (const std::uint32_t piece : ball.pieces) {
      ++owners[piece];
      for (const Vector3d& p : level.problem.pieces[piece].points) {
        EXPECT_LE((p - ball.fit.center.at).norm(), ball.fit.reach * (1 + 1e-12));
      }
    }
  }
  EXPECT_TRUE(std::all_of(owners.begin(), owners.end(), [](int n) { return n == 1; }));
  double area = 0;
  for (const Piece& piece : level.problem.pieces) area += areaOf(piece);
  EXPECT_NEAR(area, shape.area(), 1e-9 * shape.area());
}

TEST(Refine, TwoBallsFindTheHalvesOfASlab) {
  // A 4 x 1 x 1 block: each half is 2 x 1 x 1, whose best ball has its centre on the axis. By symmetry the
  // stand-off of one ball at x from the end: sqrt(max(x, 2 - x)^2 + 1/2) - 1/2, least for x = 1: sqrt(1.5) -
  // 0.5.
  const Surface block = solid(models::makeBox({4, 1, 1}));
  const Level level = refined(block, 2, 1);
  ASSERT_EQ(level.balls.size(), 2U);
  EXPECT_NEAR(worstOf(level.balls), std::sqrt(1.5) - 0.5, 0.02);
}

TEST(Refine, ThreadsDoNotMatter) {
  const Surface shape = solid(models::makeKnot(96, 12));
  const Level one = refined(shape, 16, 1);
  const Level three = refined(shape, 16, 3);
  ASSERT_EQ(one.balls.size(), three.balls.size());
  for (std::size_t i = 0; i < one.balls.size(); ++i) {
    EXPECT_EQ(one.balls[i].fit.center.at, three.balls[i].fit.center.at);
    EXPECT_EQ(one.balls[i].fit.reach, three.balls[i].fit.reach);
    EXPECT_EQ(one.balls[i].pieces, three.balls[i].pieces);
  }
}

TEST(Refine, UsesNoMoreBallsThanAreNeeded) {
  const Surface shape = solid(models::makeKnot(96, 12));
  const double fine = worstOf(refined(shape, 24, 1).balls);
  const Level few = refined(shape, 24, 1, 3 * fine);
  EXPECT_LT(few.balls.size(), 24U);
  EXPECT_LE(worstOf(few.balls), 3 * fine);
}

TEST(Refine, StopsWhenCancelled) {
  const Surface shape = solid(models::makeKnot(96, 12));
  LevelProblem problem;
  problem.pieces = surfacePieces(cellsOf(shape), 0.1 * shape.diagonal());
  problem.allowed.assign(problem.pieces.size(), {0});
  medial::Context context(1);
  context.cancel();
  EXPECT_THROW((refineLevel(problem, poorStart(shape, 8),
                            {shape, Objective::Worst, 0, refineEffort(Quality::Normal), 1, context})),
               medial::CancelledError);
}

}  // namespace
}  // namespace spheretree::builders
