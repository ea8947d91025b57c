// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/medial_axis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "medial/surface_samples.hpp"
#include "models/shapes.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

Surface surfaceOf(TriangleMesh mesh) {
  return std::move(Surface::create(std::move(mesh))).value();
}

TEST(SampleSurface, LiesOnTheSurfaceAndSpreadsByArea) {
  const Surface box = surfaceOf(models::makeBox({1, 2, 4}));
  const auto samples = sampleSurface(box, 2808);
  EXPECT_EQ(samples.size(), 2808U);
  std::size_t onLargest = 0;  // the two 2 x 4 faces hold 16 of 28
  for (const SurfaceSample& s : samples) {
    EXPECT_NEAR(box.closestPoint(s.point).distance, 0, 1e-14);
    onLargest += std::abs(std::abs(s.point.x()) - 0.5) < 1e-12 ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(onLargest) / 2800, 16.0 / 28, 0.01);
}

TEST(SampleSurface, KeepsEveryVertexOfASmallMesh) {
  const Surface ball = surfaceOf(models::makeBall(1, 2));
  const auto samples = sampleSurface(ball, 500);
  for (const Vector3d& v : ball.mesh().vertices) {
    EXPECT_TRUE(std::any_of(samples.begin(), samples.end(), [&](const auto& s) { return s.point == v; }));
  }
}

TEST(TangentBall, TouchesTheSurfaceTwice) {
  const Surface slab = surfaceOf(models::makeSlab());  // 1 x 1 x 0.001
  const auto samples = sampleSurface(slab, 200);
  for (const SurfaceSample& s : samples) {
    const Ball ball = tangentBall(slab, s);
    EXPECT_LE(ball.radius, 0.0005 * (1 + 1e-9));
    EXPECT_NEAR(slab.depth(ball.center), ball.radius, 1e-13);
  }
  const Ball middle =
      tangentBall(slab, {{0.1, 0.05, 0.0005}, slab.closestPoint({0.1, 0.05, 0.0005}).triangle});
  EXPECT_NEAR(middle.radius, 0.0005, 1e-9);
}

TEST(StaticMedialAxis, OfABallIsItsCentre) {
  const Surface ball = surfaceOf(models::makeBall(2, 4));
  const MedialAxis axis = staticMedialAxis(ball, {3000}, Context(1));
  ASSERT_FALSE(axis.balls.empty());
  const auto deepest = std::max_element(axis.balls.begin(), axis.balls.end(),
                                        [](const auto& a, const auto& b) { return a.depth < b.depth; });
  EXPECT_LT(deepest->ball.center.norm(), 0.02);
  EXPECT_NEAR(deepest->depth, 2, 0.02);
}

TEST(StaticMedialAxis, OfABoxLiesOnItsMedialPlanes) {
  // Inside a 4 x 2 x 1 box every medial point is as far from two faces: the depth of a well-sampled ball's
  // centre is the distance to the nearest face, and the ball touches more than one face.
  const Surface box = surfaceOf(models::makeBox({4, 2, 1}));
  const MedialAxis axis = staticMedialAxis(box, {6000}, Context(1));
  std::size_t large = 0;
  for (const MedialBall& ball : axis.balls) {
    const Vector3d toFaces = Vector3d(2, 1, 0.5) - ball.ball.center.cwiseAbs();
    EXPECT_NEAR(ball.depth, toFaces.minCoeff(), 1e-12);
    EXPECT_GE(ball.ball.radius, ball.depth * (1 - 1e-9));
    if (ball.depth > 0.45) {
      ++large;
      EXPECT_LT(std::abs(ball.ball.center.z()), 0.06) << "the thick balls sit on the middle plane";
    }
  }
  EXPECT_GT(large, 100U);
}

TEST(StaticMedialAxis, NeighboursAreValidAndUnique) {
  const Surface torus = surfaceOf(models::makeTorus(1, 0.3, 48, 24));
  const MedialAxis axis = staticMedialAxis(torus, {2000}, Context(2));
  ASSERT_FALSE(axis.neighbours.empty());
  EXPECT_TRUE(std::is_sorted(axis.neighbours.begin(), axis.neighbours.end()));
  EXPECT_EQ(std::adjacent_find(axis.neighbours.begin(), axis.neighbours.end()), axis.neighbours.end());
  for (const auto& [a, b] : axis.neighbours) {
    EXPECT_LT(a, b);
    ASSERT_LT(b, axis.balls.size());
  }
}

TEST(StaticMedialAxis, ExistsForEveryClosedModelAndAnyThreadCount) {
  for (const models::Model& model : models::allModels()) {
    Result<Surface> surface = Surface::create(model.make());
    if (!surface.ok()) continue;
    const MedialAxis one = staticMedialAxis(*surface, {1500}, Context(1));
    const MedialAxis seven = staticMedialAxis(*surface, {1500}, Context(7));
    ASSERT_FALSE(one.balls.empty()) << model.name;
    ASSERT_EQ(one.balls.size(), seven.balls.size()) << model.name;
    for (std::size_t i = 0; i < one.balls.size(); ++i) {
      ASSERT_EQ(one.balls[i].ball.center, seven.balls[i].ball.center) << model.name;
      ASSERT_GT(one.balls[i].depth, 0) << model.name;
      ASSERT_NEAR(surface->depth(one.balls[i].ball.center), one.balls[i].depth, 1e-12 * surface->diagonal());
    }
  }
}

}  // namespace
}  // namespace spheretree::medial
