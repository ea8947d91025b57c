// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builders/build_tree.hpp"
#include "builders/reducer.hpp"
#include "medial/cell_set.hpp"
#include "models/assemble.hpp"
#include "tests/support/solids.hpp"
#include "tests/unit/builders/solids.hpp"

namespace spheretree::builders {

/// The whole surface as one region, in cells no longer than a fraction of the diagonal.
inline medial::CellSet wholeSurface(const medial::Surface& surface, double size) {
  std::vector<medial::SurfaceCell> todo;
  std::vector<medial::SurfaceCell> cells;
  const medial::TriangleMesh& mesh = surface.mesh();
  for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
    todo.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
  }
  while (!todo.empty()) {
    const medial::SurfaceCell cell = todo.back();
    todo.pop_back();
    if (medial::longestEdge(cell) <= size * surface.diagonal()) {
      cells.push_back(cell);
      continue;
    }
    const auto [first, second] = medial::bisect(cell);
    todo.push_back(second);
    todo.push_back(first);
  }
  return {cells, {}};
}

/// One region with everything a reducer may ask for.
struct RegionOf {
  explicit RegionOf(medial::Surface given, double cellSize = 0.03)
      : surface(std::move(given)),
        cells(wholeSurface(surface, cellSize)),
        axis(medial::staticMedialAxis(surface, {400}, context)) {}

  [[nodiscard]] std::vector<medial::Ball> reduce(const Reducer& reducer, std::uint32_t maxBalls,
                                                 double goodEnough = 0,
                                                 Objective objective = Objective::Worst) const {
    return reducer.reduce({surface, cells, axis, maxBalls, goodEnough, objective, 1, Use::Final, context});
  }
  [[nodiscard]] double standOff(const medial::Ball& ball) const {
    return ball.radius - surface.depth(ball.center);
  }
  [[nodiscard]] double worst(const std::vector<medial::Ball>& balls) const {
    double worst = -std::numeric_limits<double>::infinity();
    for (const medial::Ball& ball : balls) worst = std::max(worst, standOff(ball));
    return worst;
  }
  [[nodiscard]] bool covered(const std::vector<medial::Ball>& balls) const {
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      const bool held = std::any_of(balls.begin(), balls.end(), [&](const medial::Ball& ball) {
        return cells.farthestSquared(cell, ball.center) <= ball.radius * ball.radius;
      });
      if (!held) return false;
    }
    return true;
  }

  medial::Context context{1};
  medial::Surface surface;
  medial::CellSet cells;
  medial::MedialAxis axis;
};

inline medial::TriangleMesh sphereAt(double x, double radius = 1) {
  return models::moved(models::makeBall(radius, 3), {x, 0, 0});
}

/// What holds for every reducer that gives all its balls one stand-off.
namespace facts {

inline void twoBallsAreTwoBalls(const Reducer& reducer) {
  const RegionOf region(surfaceOf(models::joined(sphereAt(-3), sphereAt(3))));
  std::vector<medial::Ball> balls = region.reduce(reducer, 2);
  ASSERT_EQ(balls.size(), 2U);
  if (balls[0].center.x() > balls[1].center.x()) std::swap(balls[0], balls[1]);
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_LT((balls[i].center - Eigen::Vector3d(i == 0 ? -3 : 3, 0, 0)).norm(), 0.03);
    EXPECT_NEAR(balls[i].radius, 1, 0.03);
  }
  // A facet of the mesh is 0.006 nearer to the centre than its corners.
  EXPECT_LT(region.worst(balls), 0.03);
}

inline void aCubeNeedsWhatItNeeds(const Reducer& reducer) {
  const RegionOf region(boxSurface(1, 1, 1));
  // One ball: through the corners from the middle.
  EXPECT_NEAR(region.worst(region.reduce(reducer, 1)), (std::sqrt(3.0) - 1) / 2, 0.01);
  // Eight: one per corner, a quarter of the side away from three faces, if the search had all the time.
  EXPECT_LT(region.worst(region.reduce(reducer, 8)), 1.15 * (std::sqrt(3.0) - 1) / 4);
}

inline void everyCellIsHeldAtOneStandOff(const Reducer& reducer) {
  for (test::Solid& solid : test::allSolids()) {
    if (solid.surface.mesh().triangles.size() > 1500) continue;  // enough of them are small
    const std::string name = solid.name;
    const RegionOf region(std::move(solid.surface), 0.06);
    for (const std::uint32_t maxBalls : {1U, 2U, 8U, 30U}) {
      SCOPED_TRACE(name + ", " + std::to_string(maxBalls) + " balls");
      const std::vector<medial::Ball> balls = region.reduce(reducer, maxBalls);
      ASSERT_GE(balls.size(), 1U);
      ASSERT_LE(balls.size(), maxBalls);
      EXPECT_TRUE(region.covered(balls));
      for (const medial::Ball& ball : balls) {
        EXPECT_NEAR(region.standOff(ball), region.standOff(balls.front()), 1e-9 * region.surface.diagonal());
      }
    }
  }
}

inline void moreBallsStandOffLess(const Reducer& reducer) {
  for (medial::TriangleMesh mesh : {models::makeTorus(2, 0.6, 48, 24), models::makeGear(9)}) {
    const RegionOf region(surfaceOf(std::move(mesh)));
    double before = std::numeric_limits<double>::infinity();
    for (const std::uint32_t maxBalls : {1U, 2U, 4U, 8U, 16U, 32U}) {
      const double worst = region.worst(region.reduce(reducer, maxBalls));
      EXPECT_LT(worst, 1.03 * before) << maxBalls << " balls";
      before = worst;
    }
  }
}

inline void goodEnoughTakesTheFewest(const Reducer& reducer) {
  const RegionOf three(
      surfaceOf(models::joined(models::joined(sphereAt(-5), sphereAt(0)), sphereAt(4, 0.5))));
  const std::vector<medial::Ball> balls = three.reduce(reducer, 8, 0.1);
  EXPECT_EQ(balls.size(), 3U);
  EXPECT_LE(three.worst(balls), 0.1);
  // Nothing is good enough for two balls, which do what they can.
  EXPECT_EQ(three.reduce(reducer, 2, 0.1).size(), 2U);
  // For what one ball can do, one ball is enough.
  const double one = three.worst(three.reduce(reducer, 1));
  EXPECT_EQ(three.reduce(reducer, 8, 1.01 * one).size(), 1U);
}

inline void otherObjectivesCoverToo(const Reducer& reducer) {
  const RegionOf region(surfaceOf(models::makeGear(9)));
  const auto meanOf = [&](Objective objective) {
    const std::vector<medial::Ball> balls = region.reduce(reducer, 8, 0, objective);
    EXPECT_TRUE(region.covered(balls));
    return region.worst(balls);
  };
  const double worst = meanOf(Objective::Worst);
  EXPECT_LE(worst, meanOf(Objective::Mean) * (1 + 1e-3));
  EXPECT_LE(worst, meanOf(Objective::Volume) * (1 + 1e-3));
}

inline void sameRequestSameBits(const Reducer& reducer) {
  const RegionOf region(surfaceOf(models::makeGear(9)));
  const std::vector<medial::Ball> first = region.reduce(reducer, 8);
  const std::vector<medial::Ball> second = region.reduce(reducer, 8);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].center, second[i].center);
    EXPECT_EQ(first[i].radius, second[i].radius);
  }
}

inline void stopsInTheMiddle(const Reducer& reducer) {
  RegionOf region(surfaceOf(models::makeKnot(200, 16)), 0.004);
  std::atomic<bool> started{false};
  std::thread canceller([&] {
    while (!started) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    region.context.cancel();
  });
  const auto start = std::chrono::steady_clock::now();
  started = true;
  // Uncancelled, this takes several times as long as allowed here.
  EXPECT_THROW((void)region.reduce(reducer, 400), medial::CancelledError);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
  canceller.join();
}

/// Whole trees, proved from outside; thin solids and solid cover included.
inline void treesAreCertified(const std::string& builder) {
  for (const test::Solid& solid : test::allSolids()) {
    if (solid.name != "torus" && solid.name != "slab" && solid.name != "needle" &&
        solid.name != "hollow_ball")
      continue;
    for (const Cover cover : {Cover::Surface, Cover::Solid}) {
      if (cover == Cover::Solid && solid.name != "torus") continue;
      BuildSettings settings;
      settings.builder = builder;
      settings.levels = 3;
      settings.cover = cover;
      const Result<BuildResult> built = buildTree(solid.surface, settings, medial::Context(1));
      EXPECT_TRUE(built.ok()) << solid.name << ": " << (built.ok() ? "" : built.error().message);
    }
  }
}

}  // namespace facts
}  // namespace spheretree::builders
