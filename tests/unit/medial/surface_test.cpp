// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include <Eigen/Geometry>

#include "medial/random.hpp"
#include "models/shapes.hpp"
#include "tests/support/naive.hpp"

namespace spheretree::medial {
namespace {

using Eigen::Vector3d;

Surface surfaceOf(TriangleMesh mesh) {
  Result<Surface> surface = Surface::create(std::move(mesh));
  EXPECT_TRUE(surface.ok()) << (surface.ok() ? "" : surface.error().message);
  return std::move(surface).value();
}

Vector3d randomIn(Random& random, const Eigen::AlignedBox3d& box, double margin) {
  const Vector3d grow = margin * box.sizes();
  Vector3d p;
  for (int k = 0; k < 3; ++k) p[k] = random.uniform(box.min()[k] - grow[k], box.max()[k] + grow[k]);
  return p;
}

TEST(Surface, BoxDistancesAreKnown) {
  const Surface box = surfaceOf(models::makeBox({2, 2, 2}));
  EXPECT_DOUBLE_EQ(box.depth(Vector3d::Zero()), 1);
  EXPECT_DOUBLE_EQ(box.depth({0.75, 0, 0}), 0.25);
  EXPECT_DOUBLE_EQ(box.depth({2, 0, 0}), -1);
  EXPECT_DOUBLE_EQ(box.depth({2, 2, 2}), -std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(box.depth({2, 2, 0.5}), -std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(box.volume(), 8);
  EXPECT_DOUBLE_EQ(box.area(), 24);
  EXPECT_DOUBLE_EQ(box.diagonal(), std::sqrt(12.0));
}

TEST(Surface, PointsOnTheSurfaceHaveNoDepth) {
  const Surface box = surfaceOf(models::makeBox({1, 2, 3}));
  for (std::size_t t = 0; t < box.mesh().triangles.size(); ++t) {
    const Vector3d middle = (box.mesh().corner(t, 0) + box.mesh().corner(t, 1)) / 2;
    EXPECT_DOUBLE_EQ(box.closestPoint(middle).distance, 0);
  }
}

TEST(Surface, AgreesWithBruteForce) {
  constexpr std::uint64_t kSeed = 20260101;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  Random random(kSeed);
  for (const models::Model& model : models::allModels()) {
    Result<Surface> made = Surface::create(model.make());
    if (!made.ok()) continue;
    const Surface& surface = *made;
    const TriangleMesh& mesh = surface.mesh();
    for (int i = 0; i < 60; ++i) {
      const Vector3d p = randomIn(random, surface.bounds(), 0.3);
      const double expected = test::naive::distance(p, mesh);
      const ClosestPoint closest = surface.closestPoint(p);
      ASSERT_NEAR(closest.distance, expected, 1e-12 * surface.diagonal())
          << model.name << " at " << p.transpose();
      ASSERT_NEAR((closest.point - p).norm(), closest.distance, 1e-15);
      const double winding = test::naive::windingNumber(mesh, p);
      ASSERT_EQ(surface.inside(p), std::lround(winding) > 0) << model.name << " at " << p.transpose();
    }
  }
}

TEST(Surface, RoughDistancesAreExactButInTheMiddleOfABall) {
  constexpr std::uint64_t kSeed = 20261127;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  Random random(kSeed);
  // More than four triangles for each of the leaves that may be looked into.
  const Surface ball = surfaceOf(models::makeBall(1, 5));
  for (int i = 0; i < 200; ++i) {
    const Vector3d p = randomIn(random, ball.bounds(), 0.3);
    const ClosestPoint exact = ball.closestPoint(p);
    const ClosestPoint rough = ball.roughlyClosestPoint(p);
    if (p.norm() > 0.2) {
      ASSERT_EQ(rough.distance, exact.distance) << p.transpose();
      ASSERT_EQ(rough.triangle, exact.triangle) << p.transpose();
    }
    const Vector3d nearMiddle = 1e-5 * p;
    const double least = ball.closestPoint(nearMiddle).distance;
    const ClosestPoint near = ball.roughlyClosestPoint(nearMiddle);
    ASSERT_GE(near.distance, least);
    ASSERT_LE(near.distance, 1.001 * least);
    ASSERT_NEAR(test::naive::distance(near.point, ball.mesh()), 0, 1e-12);
  }
}

TEST(Surface, RaysThroughVerticesAndEdgesAreCountedOnce) {
  // Query points straight below the vertices, edge midpoints and face centres of an icosphere.
  const Surface ball = surfaceOf(models::makeBall(1, 2));
  const TriangleMesh& mesh = ball.mesh();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d& a = mesh.corner(t, k);
      const Vector3d middle = (a + mesh.corner(t, (k + 1) % 3)) / 2;
      for (const Vector3d& on : {a, middle}) {
        for (int axis = 0; axis < 3; ++axis) {
          Vector3d p = on;
          p[axis] = 0;
          if (p.norm() > 0.9) continue;
          EXPECT_TRUE(ball.inside(p)) << p.transpose();
        }
      }
    }
  }
}

TEST(Surface, CavitiesAreOutsideAndOverlapsInside) {
  const Surface hollow = surfaceOf(models::makeHollowBall(1, 0.5, 2));
  EXPECT_FALSE(hollow.inside(Vector3d::Zero()));
  EXPECT_NEAR(hollow.depth(Vector3d::Zero()), -0.5, 0.05);
  EXPECT_TRUE(hollow.inside({0.75, 0, 0}));

  TriangleMesh two = models::makeBox({2, 2, 2});
  const TriangleMesh other = models::makeBox({1, 1, 1});
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  two.vertices.insert(two.vertices.end(), other.vertices.begin(), other.vertices.end());
  const Surface nested = surfaceOf(std::move(two));
  EXPECT_TRUE(nested.inside(Vector3d::Zero())) << "wound around twice is still inside";
}

TEST(Surface, ThinBoxesKeepTheirDistances) {
  // Inside a box the distance is that to the nearest of six planes, however thin the triangles are.
  for (const double thin : {1e-1, 1e-3, 1e-5, 1e-7}) {
    SCOPED_TRACE(testing::Message() << "1 : " << thin);
    Random random(3);
    for (const Vector3d& size : {Vector3d(1, thin, thin), Vector3d(1, 0.7, thin)}) {
      TriangleMesh mesh = models::makeBox(size);
      const Eigen::AngleAxisd turn(1.234, Vector3d(3, -1, 2).normalized());
      for (Vector3d& v : mesh.vertices) v = turn * v;
      const Surface box = surfaceOf(std::move(mesh));
      for (int i = 0; i < 200; ++i) {
        const Vector3d p = size.cwiseProduct(
            Vector3d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)));
        const double expected = (size / 2 - p.cwiseAbs()).minCoeff();
        EXPECT_NEAR(box.closestPoint(turn * p).distance, expected, 1e-15) << p.transpose();
      }
    }
  }
}

TEST(Surface, NeedleTrianglesKeepTheirDistance) {
  // A spike whose long faces are 1 : 1e-9.
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1e-9, 0, 0}, {0, 1e-9, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const Surface spike = surfaceOf(std::move(mesh));
  EXPECT_NEAR(spike.closestPoint({0.5, 0, 0.5}).distance, 0.5, 1e-9);
  EXPECT_NEAR(spike.closestPoint({0, -0.25, 0.25}).distance, 0.25, 1e-9);
  EXPECT_FALSE(spike.inside({0.5, 0, 0.5}));
}

TEST(Surface, RefusesWhatIsNoSolid) {
  const auto reason = [](TriangleMesh mesh) {
    const Result<Surface> surface = Surface::create(std::move(mesh));
    EXPECT_FALSE(surface.ok());
    return surface.ok() ? std::string() : surface.error().message;
  };
  EXPECT_NE(reason({}).find("no triangles"), std::string::npos);
  TriangleMesh open = models::makeBox({1, 1, 1});
  open.triangles.pop_back();
  EXPECT_NE(reason(open).find("open"), std::string::npos);
  TriangleMesh insideOut = models::makeBox({1, 1, 1});
  for (auto& t : insideOut.triangles) std::swap(t[0], t[1]);
  EXPECT_NE(reason(insideOut).find("volume"), std::string::npos);
  TriangleMesh lost = models::makeBox({1, 1, 1});
  lost.triangles[3][1] = 99;
  EXPECT_NE(reason(lost).find("99"), std::string::npos);
  TriangleMesh nan = models::makeBox({1, 1, 1});
  nan.vertices[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(reason(nan).find("finite"), std::string::npos);
}

TEST(Surface, TrianglesNearFindsExactlyTheBoxesThatMeet) {
  const Surface ball = surfaceOf(models::makeBall(1, 3));
  const Eigen::AlignedBox3d box(Vector3d(0.5, 0.1, 0.2), Vector3d(0.9, 0.6, 0.5));
  std::vector<std::uint32_t> expected;
  for (std::uint32_t t = 0; t < ball.mesh().triangles.size(); ++t) {
    Eigen::AlignedBox3d own;
    for (std::size_t k = 0; k < 3; ++k) own.extend(ball.mesh().corner(t, k));
    if (own.intersects(box)) expected.push_back(t);
  }
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(ball.trianglesNear(box), expected);
}

TEST(Surface, AnswersManyThreadsAtOnce) {
  const Surface torus = surfaceOf(models::makeTorus(1, 0.3, 32, 16));
  std::vector<Vector3d> points;
  Random random(7);
  for (int i = 0; i < 2000; ++i) points.push_back(randomIn(random, torus.bounds(), 0.1));
  std::vector<double> expected;
  for (const Vector3d& p : points) expected.push_back(torus.depth(p));
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (std::size_t k = 0; k < wrong.size(); ++k) {
    threads.emplace_back([&, k] {
      for (std::size_t i = 0; i < points.size(); ++i)
        wrong[k] += torus.depth(points[i]) != expected[i] ? 1 : 0;
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

}  // namespace
}  // namespace spheretree::medial
