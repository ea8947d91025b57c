// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/adaptive_axis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "medial/parallel.hpp"
#include "medial/solid_cells.hpp"
#include "models/shapes.hpp"

namespace spheretree::medial {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

Surface surfaceOf(TriangleMesh mesh) {
  return std::move(Surface::create(std::move(mesh))).value();
}

/// A smooth solid without symmetries, about 3.4 x 2.4 x 1.8.
Surface potato() {
  TriangleMesh mesh = models::makeBall(1, 4);
  for (Vector3d& v : mesh.vertices) {
    v = Vector3d(1.7 * v.x(), 1.2 * v.y(), 0.9 * v.z()) *
        (1 + 0.15 * std::sin(3 * v.x() + 2 * v.y()) + 0.1 * v.z());
  }
  return surfaceOf(std::move(mesh));
}

void cut(const SurfaceCell& cell, double size, const AlignedBox3d& region, std::vector<SurfaceCell>& out) {
  AlignedBox3d box;
  for (const Vector3d& corner : cell) box.extend(corner);
  if (!box.intersects(region)) return;
  if (longestEdge(cell) <= size) {
    out.push_back(cell);
    return;
  }
  const auto [first, second] = bisect(cell);
  cut(first, size, region, out);
  cut(second, size, region, out);
}

/// The surface inside a box in cells of at most this size.
CellSet cellsIn(const Surface& surface, double size, const AlignedBox3d& region) {
  std::vector<SurfaceCell> cells;
  const TriangleMesh& mesh = surface.mesh();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    cut({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, size, region, cells);
  }
  return {cells, {}};
}

CellSet allCells(const Surface& surface, double size) {
  return cellsIn(surface, size, surface.bounds());
}

double worstOverhang(const RegionAxis& region) {
  double worst = 0;
  for (const MedialBall& ball : region.axis.balls) worst = std::max(worst, ball.ball.radius - ball.depth);
  return worst;
}

/// How far the best ball for the worst served cell sticks out when it holds the cell.
double worstStandOff(const RegionAxis& region, const CellSet& cells) {
  double worst = 0;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    double least = std::numeric_limits<double>::infinity();
    for (const MedialBall& ball : region.axis.balls) {
      least = std::min(least, std::sqrt(cells.farthestSquared(cell, ball.ball.center)) - ball.depth);
    }
    worst = std::max(worst, least);
  }
  return worst;
}

void expectSame(const RegionAxis& a, const RegionAxis& b) {
  ASSERT_EQ(a.axis.balls.size(), b.axis.balls.size());
  for (std::size_t i = 0; i < a.axis.balls.size(); ++i) {
    ASSERT_EQ(a.axis.balls[i].ball.center, b.axis.balls[i].ball.center);
    ASSERT_EQ(a.axis.balls[i].ball.radius, b.axis.balls[i].ball.radius);
    ASSERT_EQ(a.axis.balls[i].depth, b.axis.balls[i].depth);
  }
  EXPECT_EQ(a.axis.neighbours, b.axis.neighbours);
  EXPECT_EQ(a.sites.size(), b.sites.size());
}

TEST(AdaptiveAxis, DepthIsTheDistanceToTheSurface) {
  const Surface surface = potato();
  const RegionAxis coarse = coarseAxis(surface, 300, Context(1));
  const RegionAxis axis = refineAxis(surface, coarse, allCells(surface, 0.2), {0.05, 200}, Context(1));
  ASSERT_GE(axis.axis.balls.size(), 200U);
  for (const MedialBall& ball : axis.axis.balls) {
    ASSERT_GT(ball.depth, 0);
    ASSERT_NEAR(surface.depth(ball.ball.center), ball.depth, 1e-12);
    ASSERT_GE(ball.ball.radius, ball.depth * (1 - 1e-5));
  }
}

TEST(AdaptiveAxis, MeetsItsGoals) {
  const std::vector<std::pair<std::string, Surface>> solids = [] {
    std::vector<std::pair<std::string, Surface>> list;
    list.emplace_back("potato", potato());
    list.emplace_back("box", surfaceOf(models::makeBox({3, 2, 1})));
    list.emplace_back("torus", surfaceOf(models::makeTorus(1, 0.4, 48, 24)));
    list.emplace_back("cylinder", surfaceOf(models::makeCylinder(0.6, 2, 32)));
    list.emplace_back("l_block", surfaceOf(models::makeLBlock()));
    return list;
  }();
  for (const auto& [name, surface] : solids) {
    SCOPED_TRACE(name);
    const RegionAxis coarse = coarseAxis(surface, 40, Context(1));
    const double goal = 0.02 * surface.diagonal();
    const CellSet cells = allCells(surface, goal);
    const double before =
        worstOverhang(refineAxis(surface, coarse, cells, {surface.diagonal(), 0}, Context(1)));
    EXPECT_GT(before, goal) << "nothing to refine: the test is too easy";
    const RegionAxis axis = refineAxis(surface, coarse, cells, {goal, 150}, Context(1));
    EXPECT_LE(worstOverhang(axis), goal);
    EXPECT_GE(axis.axis.balls.size(), 150U);
    EXPECT_LE(worstStandOff(axis, cells), goal);
    EXPECT_GT(axis.sites.size(), coarse.sites.size());
  }
}

TEST(AdaptiveAxis, FinerGoalsAreNotWorse) {
  const Surface surface = potato();
  const RegionAxis coarse = coarseAxis(surface, 60, Context(1));
  const CellSet cells = allCells(surface, 0.3);
  double last = std::numeric_limits<double>::infinity();
  double goal = 0.4;
  for (int i = 0; i < 5; ++i, goal /= 2) {
    const double worst = worstOverhang(refineAxis(surface, coarse, cells, {goal, 0}, Context(1)));
    EXPECT_LE(worst, std::min(goal, last));
    last = worst;
  }
}

TEST(AdaptiveAxis, OfARegularBallIsOneCentre) {
  // All 642 vertices are on one sphere: one Voronoi vertex in some three thousand tetrahedra.
  const Surface surface = surfaceOf(models::makeBall(1, 3));
  const RegionAxis coarse = coarseAxis(surface, 642, Context(1));
  EXPECT_GT(coarse.tetrahedra.size(), 500U);
  const RegionAxis axis = refineAxis(surface, coarse, allCells(surface, 0.2), {0.05, 1}, Context(1));
  ASSERT_EQ(axis.axis.balls.size(), 1U);
  EXPECT_LT(axis.axis.balls[0].ball.center.norm(), 1e-9);
  EXPECT_NEAR(axis.axis.balls[0].ball.radius, 1, 1e-9);
  EXPECT_LT(axis.axis.balls[0].depth, 1);
  EXPECT_TRUE(axis.axis.neighbours.empty());
}

TEST(AdaptiveAxis, OfABoxLiesWhereTwoFacesAreEquallyNear) {
  // Deep balls of a 4 x 2 x 1 box touch its two large faces: their centres are in the middle plane.
  const Surface surface = surfaceOf(models::makeBox({4, 2, 1}));
  const RegionAxis coarse = coarseAxis(surface, 200, Context(1));
  const RegionAxis axis = refineAxis(surface, coarse, allCells(surface, 0.1), {0.01, 100}, Context(1));
  std::size_t deep = 0;
  for (const MedialBall& ball : axis.axis.balls) {
    EXPECT_NEAR(ball.depth, (Vector3d(2, 1, 0.5) - ball.ball.center.cwiseAbs()).minCoeff(), 1e-12);
    if (ball.depth < 0.49) continue;
    ++deep;
    EXPECT_LE(std::abs(ball.ball.center.z()), 0.01 + 1e-12);
  }
  EXPECT_GT(deep, 10U);
}

TEST(AdaptiveAxis, CostsWhatTheRegionCosts) {
  // The first tooth of a comb does not care how many follow.
  const auto sitesOfFirstTooth = [](std::uint32_t teeth) {
    const Surface surface = surfaceOf(models::makeComb(teeth));
    const RegionAxis coarse = coarseAxis(surface, 200 * teeth, Context(1));
    AlignedBox3d tooth = surface.bounds();
    tooth.max().x() = tooth.min().x() + 1;
    const RegionAxis axis =
        refineAxis(surface, coarse, cellsIn(surface, 0.2, tooth), {0.05, 200}, Context(1));
    for (const MedialBall& ball : axis.axis.balls) {
      EXPECT_LT(ball.ball.center.x(), tooth.max().x() + 1) << "of another tooth";
    }
    return static_cast<double>(axis.sites.size());
  };
  EXPECT_NEAR(sitesOfFirstTooth(40) / sitesOfFirstTooth(5), 1, 0.2);
}

TEST(AdaptiveAxis, ChildrenReuseTheirParentsWork) {
  const Surface surface = potato();
  const RegionAxis coarse = coarseAxis(surface, 300, Context(1));
  const RegionAxis parent = refineAxis(surface, coarse, allCells(surface, 0.2), {0.1, 200}, Context(1));
  AlignedBox3d half = surface.bounds();
  half.max().x() = 0;
  const CellSet cells = cellsIn(surface, 0.1, half);
  // The goal of the parent is met at once: nothing is inserted.
  const RegionAxis same = refineAxis(surface, parent, cells, {0.1, 0}, Context(1));
  EXPECT_LT(same.sites.size(), parent.sites.size());
  for (const SurfaceSample& site : same.sites) {
    EXPECT_TRUE(std::any_of(parent.sites.begin(), parent.sites.end(),
                            [&](const SurfaceSample& other) { return other.point == site.point; }));
  }
  const RegionAxis finer = refineAxis(surface, parent, cells, {0.01, 0}, Context(1));
  EXPECT_GT(finer.sites.size(), same.sites.size());
  EXPECT_LE(worstOverhang(finer), 0.01);
}

TEST(AdaptiveAxis, EveryCellOfEveryModelHasABallNearBy) {
  for (const models::Model& model : models::allModels()) {
    Result<Surface> surface = Surface::create(model.make());
    if (!surface.ok()) continue;
    SCOPED_TRACE(std::string(model.name));
    const double goal = 0.02 * surface->diagonal();
    const CellSet cells = allCells(*surface, 2 * goal);
    const RegionAxis coarse = coarseAxis(*surface, 200, Context(1));
    const RegionAxis axis = refineAxis(*surface, coarse, cells, {goal, 100}, Context(1));
    // A cell's radius is at most 2/3 of its longest median, that at most its longest edge.
    EXPECT_LE(worstStandOff(axis, cells), 2.0 / 3 * 2 * goal);
    EXPECT_FALSE(axis.axis.balls.empty());
  }
}

TEST(AdaptiveAxis, EndsWhenTheGoalIsOutOfReach) {
  for (const char* name :
       {"cube", "cylinder", "ball", "slab", "needle", "spike", "tangent_balls", "box_sliver"}) {
    SCOPED_TRACE(name);
    for (const models::Model& model : models::allModels()) {
      if (model.name != name) continue;
      const Surface surface = surfaceOf(model.make());
      const CellSet cells = allCells(surface, 0.1 * surface.diagonal());
      const RegionAxis coarse = coarseAxis(surface, 100, Context(1));
      const RegionAxis axis = refineAxis(surface, coarse, cells, {0, 200}, Context(1));
      EXPECT_FALSE(axis.axis.balls.empty());
      EXPECT_LE(axis.sites.size(), coarse.sites.size() + 900);
    }
  }
}

TEST(AdaptiveAxis, FillsTheThinnestPlate) {
  const Surface surface = surfaceOf(models::makeSlab());  // 1 x 1 x 0.001
  const RegionAxis coarse = coarseAxis(surface, 300, Context(1));
  const CellSet cells = allCells(surface, 0.1);
  const RegionAxis axis = refineAxis(surface, coarse, cells, {0.05, 200}, Context(1));
  EXPECT_GE(axis.axis.balls.size(), 200U);
  for (const MedialBall& ball : axis.axis.balls) EXPECT_LE(ball.depth, 0.0005 * (1 + 1e-9));
  EXPECT_LE(worstStandOff(axis, cells), 0.1);
}

TEST(AdaptiveAxis, CoversTheInsideOfASolidRegion) {
  const Surface surface = surfaceOf(models::makeBox({2, 2, 2}));
  std::vector<SolidCell> solid;
  for (const AlignedBox3d& octant : octants(solidRootCube(surface))) {
    solid.push_back({octant, solidPoints(surface, octant, surface.trianglesNear(octant))});
  }
  const CellSet cells({}, solid);
  const RegionAxis coarse = coarseAxis(surface, 100, Context(1));
  const RegionAxis axis = refineAxis(surface, coarse, cells, {0.1, 50}, Context(1));
  EXPECT_GE(axis.axis.balls.size(), 50U);
  EXPECT_LE(worstOverhang(axis), 0.1);
}

TEST(AdaptiveAxis, NeighboursAreValidAndEverybodyHasOne) {
  for (const char* name : {"torus", "slab", "spike", "gear"}) {
    SCOPED_TRACE(name);
    for (const models::Model& model : models::allModels()) {
      if (model.name != name) continue;
      const Surface surface = surfaceOf(model.make());
      const RegionAxis coarse = coarseAxis(surface, 200, Context(1));
      const CellSet cells = allCells(surface, 0.05 * surface.diagonal());
      const MedialAxis axis =
          refineAxis(surface, coarse, cells, {0.03 * surface.diagonal(), 150}, Context(1)).axis;
      EXPECT_TRUE(std::is_sorted(axis.neighbours.begin(), axis.neighbours.end()));
      EXPECT_EQ(std::adjacent_find(axis.neighbours.begin(), axis.neighbours.end()), axis.neighbours.end());
      std::vector<bool> linked(axis.balls.size(), false);
      for (const auto& [a, b] : axis.neighbours) {
        ASSERT_LT(a, b);
        ASSERT_LT(b, axis.balls.size());
        linked[a] = linked[b] = true;
      }
      EXPECT_LE(std::count(linked.begin(), linked.end(), false), 3);
    }
  }
}

TEST(AdaptiveAxis, IsTheSameOnAnyThread) {
  const Surface surface = potato();
  const RegionAxis coarse = coarseAxis(surface, 300, Context(1));
  expectSame(coarse, coarseAxis(surface, 300, Context(5)));
  std::vector<CellSet> regions;
  for (int k = 0; k < 8; ++k) {
    AlignedBox3d box = surface.bounds();
    const Vector3d middle = box.center();
    for (int axis = 0; axis < 3; ++axis) {
      if ((k >> axis & 1) != 0) {
        box.min()[axis] = middle[axis];
      } else {
        box.max()[axis] = middle[axis];
      }
    }
    regions.push_back(cellsIn(surface, 0.15, box));
  }
  const Context one(1);
  const Context four(4);
  std::vector<RegionAxis> together(regions.size());
  parallelFor(regions.size(), four, [&](std::size_t i) {
    together[i] = refineAxis(surface, coarse, regions[i], {0.03, 200}, four);
  });
  for (std::size_t i = 0; i < regions.size(); ++i) {
    expectSame(together[i], refineAxis(surface, coarse, regions[i], {0.03, 200}, one));
  }
}

TEST(AdaptiveAxis, DoesNotHangOnRounding) {
  TriangleMesh wedge = models::makeBox({3, 2, 1});
  for (Vector3d& v : wedge.vertices) {
    v += Vector3d(0.21 * v.y() + 0.1 * v.z(), 0.13 * v.x() * v.z(), 0.07 * v.y());
  }
  const auto axisOf = [&](double scale) {
    // Equal but for rounding: 1 / 3 is no power of two.
    TriangleMesh mesh = wedge;
    for (Vector3d& v : mesh.vertices) v = v * scale / scale;
    const Surface surface = surfaceOf(std::move(mesh));
    const RegionAxis coarse = coarseAxis(surface, 150, Context(1));
    return refineAxis(surface, coarse, allCells(surface, 0.2), {0.03, 200}, Context(1));
  };
  const RegionAxis one = axisOf(1);
  const RegionAxis other = axisOf(1e-3 / 3);
  EXPECT_GT(one.sites.size(), 150U);
  ASSERT_EQ(one.axis.balls.size(), other.axis.balls.size());
  EXPECT_EQ(one.axis.neighbours, other.axis.neighbours);
  for (std::size_t i = 0; i < one.axis.balls.size(); ++i) {
    EXPECT_LT((one.axis.balls[i].ball.center - other.axis.balls[i].ball.center).norm(), 1e-6);
  }
}

TEST(AdaptiveAxis, CanBeCancelled) {
  const Surface surface = potato();
  const RegionAxis coarse = coarseAxis(surface, 300, Context(1));
  const CellSet cells = allCells(surface, 0.2);
  Context context(1);
  context.cancel();
  EXPECT_THROW(static_cast<void>(refineAxis(surface, coarse, cells, {0.05, 200}, context)), CancelledError);
}

}  // namespace
}  // namespace spheretree::medial
