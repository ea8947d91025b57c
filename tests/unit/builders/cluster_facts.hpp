// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/unit/builders/reducer_facts.hpp"

/// What holds for the reducers that begin with many medial balls and end with few: merge and burst.
namespace spheretree::builders::facts {

inline void sameBalls(const std::vector<medial::Ball>& first, const std::vector<medial::Ball>& second) {
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].center, second[i].center);
    EXPECT_EQ(first[i].radius, second[i].radius);
  }
}

inline void oneBallIsOneBall(const Reducer& reducer) {
  const RegionOf region(surfaceOf(models::makeBall(1, 3)));
  // However many there may be: when one is good enough it is all there is.
  for (const auto& [maxBalls, goodEnough] : {std::pair(1U, 0.0), std::pair(8U, 0.05)}) {
    const std::vector<medial::Ball> balls = region.reduce(reducer, maxBalls, goodEnough);
    ASSERT_EQ(balls.size(), 1U);
    EXPECT_LT(balls.front().center.norm(), 0.01);
    EXPECT_NEAR(balls.front().radius, 1, 0.01);
  }
}

/// With a ball for each part, or more, no ball has to do with two of them.
inline void partsFarApartStayApart(const Reducer& reducer) {
  constexpr std::array<double, 3> kPlaces{-6, 0, 5};
  constexpr std::array<double, 3> kRadii{1, 0.1, 0.7};
  medial::TriangleMesh parts = sphereAt(kPlaces[0], kRadii[0]);
  for (const std::size_t i : {1U, 2U}) parts = models::joined(parts, sphereAt(kPlaces[i], kRadii[i]));
  const RegionOf region(surfaceOf(std::move(parts)), 0.01);
  for (const std::uint32_t maxBalls : {3U, 4U, 5U, 8U, 20U}) {
    SCOPED_TRACE(std::to_string(maxBalls) + " balls");
    const std::vector<medial::Ball> balls = region.reduce(reducer, maxBalls);
    EXPECT_TRUE(region.covered(balls));
    for (const medial::Ball& ball : balls) {
      int met = 0;
      for (const std::size_t i : {0U, 1U, 2U}) {
        const double distance = (ball.center - Eigen::Vector3d(kPlaces[i], 0, 0)).norm();
        met += distance < ball.radius + kRadii[i] ? 1 : 0;
      }
      EXPECT_EQ(met, 1);
    }
  }
}

/// Two pairs of balls under two: those that are near each other come together.
inline void neighboursComeTogether(const Reducer& reducer) {
  const medial::TriangleMesh left = models::joined(sphereAt(-6, 0.8), sphereAt(-4, 0.8));
  const medial::TriangleMesh right = models::joined(sphereAt(4, 0.8), sphereAt(6, 0.8));
  const RegionOf region(surfaceOf(models::joined(left, right)));
  const std::vector<medial::Ball> balls = region.reduce(reducer, 2);
  ASSERT_EQ(balls.size(), 2U);
  EXPECT_TRUE(region.covered(balls));
  EXPECT_LT(balls[0].center.x() * balls[1].center.x(), 0);
  for (const medial::Ball& ball : balls) EXPECT_LT(ball.radius, std::abs(ball.center.x()));
  EXPECT_EQ(region.reduce(reducer, 4).size(), 4U);
  EXPECT_LT(region.worst(region.reduce(reducer, 4)), 0.03);
}

inline void everyCellIsHeld(const Reducer& reducer) {
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
    }
  }
}

inline void oneTriangleTakesOneBall(const Reducer& reducer) {
  RegionOf region(boxSurface(2, 3, 4));
  const medial::TriangleMesh& mesh = region.surface.mesh();
  region.cells = {std::vector<medial::SurfaceCell>{{mesh.corner(0, 0), mesh.corner(0, 1), mesh.corner(0, 2)}},
                  {}};
  for (const std::uint32_t maxBalls : {1U, 8U}) {
    const std::vector<medial::Ball> balls = region.reduce(reducer, maxBalls);
    EXPECT_EQ(balls.size(), 1U);
    EXPECT_TRUE(region.covered(balls));
  }
}

/// All samples of its axis are cospherical, and the middle of it is the centre of many tetrahedra.
inline void aCubeInOneAndInEight(const Reducer& reducer) {
  const RegionOf region(boxSurface(1, 1, 1));
  const double one = (std::sqrt(3.0) - 1) / 2;
  EXPECT_NEAR(region.worst(region.reduce(reducer, 1)), one, 0.01);
  const std::vector<medial::Ball> eight = region.reduce(reducer, 8);
  EXPECT_TRUE(region.covered(eight));
  // One per corner would take half of it. Greedy ways do not get there.
  EXPECT_GT(region.worst(eight), 0.99 * one / 2);
  EXPECT_LT(region.worst(eight), 1.5 * one / 2);
}

/// A plate is a square: the ball of n x n parts reaches as far as half a diagonal of one.
inline void aPlateIsASquare(const Reducer& reducer) {
  const RegionOf region(boxSurface(1, 1, 0.001));
  for (const double n : {1.0, 2.0}) {
    const std::vector<medial::Ball> balls = region.reduce(reducer, static_cast<std::uint32_t>(n * n));
    EXPECT_TRUE(region.covered(balls));
    EXPECT_GT(region.worst(balls), 0.99 * std::sqrt(0.5) / n);
    EXPECT_LT(region.worst(balls), 1.15 * std::sqrt(0.5) / n);
  }
}

/// With any overhang that can be had: it is kept to, and the larger it is the fewer balls there are.
inline void goodEnoughEndsEarly(const Reducer& reducer) {
  const RegionOf region(surfaceOf(models::makeGear(9)));
  const double least = region.worst(region.reduce(reducer, 16));
  std::size_t before = 16;
  for (const double factor : {1.0, 1.3, 1.7, 2.5, 4.0}) {
    const double goodEnough = factor * least * (1 + 1e-6);
    const std::vector<medial::Ball> balls = region.reduce(reducer, 16, goodEnough);
    SCOPED_TRACE(std::to_string(factor) + " times the least");
    EXPECT_TRUE(region.covered(balls));
    EXPECT_LE(region.worst(balls), goodEnough);
    EXPECT_LE(balls.size(), before);
    before = balls.size();
  }
  EXPECT_LT(before, 8U);
  // What cannot be had changes nothing.
  sameBalls(region.reduce(reducer, 16, 0.5 * least), region.reduce(reducer, 16));
}

/// A request is a pure function, whatever the threads of its context and whoever else asks meanwhile.
inline void sameBitsForAnyThreads(const Reducer& reducer, const std::string& builder) {
  const RegionOf region(surfaceOf(models::makeGear(9)));
  const std::vector<medial::Ball> expected = region.reduce(reducer, 8);
  std::array<std::vector<medial::Ball>, 3> results;
  std::vector<std::thread> threads;
  for (std::vector<medial::Ball>& result : results) {
    threads.emplace_back([&] {
      const medial::Context three(3);
      result = reducer.reduce(
          {region.surface, region.cells, region.axis, 8, 0, Objective::Worst, 1, Use::Final, three});
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<medial::Ball>& result : results) sameBalls(result, expected);

  BuildSettings settings;
  settings.builder = builder;
  settings.levels = 3;
  const auto nodesWith = [&](unsigned count) {
    Result<BuildResult> built = buildTree(region.surface, settings, medial::Context(count));
    EXPECT_TRUE(built.ok());
    const std::span<const Node> nodes = built->tree.nodes();
    return std::vector<Node>(nodes.begin(), nodes.end());
  };
  const std::vector<Node> one = nodesWith(1);
  const std::vector<Node> three = nodesWith(3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].parent, three[i].parent);
    EXPECT_EQ(one[i].ball.center.x, three[i].ball.center.x);
    EXPECT_EQ(one[i].ball.center.y, three[i].ball.center.y);
    EXPECT_EQ(one[i].ball.center.z, three[i].ball.center.z);
    EXPECT_EQ(one[i].ball.radius, three[i].ball.radius);
  }
}

inline void doesWithoutAnAxis(const Reducer& reducer) {
  RegionOf region(surfaceOf(models::makeTorus(2, 0.6, 48, 24)));
  const double with = region.worst(region.reduce(reducer, 8));
  region.axis = {};
  const std::vector<medial::Ball> balls = region.reduce(reducer, 8);
  EXPECT_TRUE(region.covered(balls));
  EXPECT_LT(region.worst(balls), 1.3 * with);
}

}  // namespace spheretree::builders::facts
