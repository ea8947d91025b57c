// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/mesh_check.hpp"

#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "models/shapes.hpp"

namespace spheretree::io {
namespace {

using Eigen::Vector3d;
using medial::TriangleMesh;

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b, const Vector3d& shift) {
  const auto base = static_cast<std::uint32_t>(a.vertices.size());
  for (const Vector3d& vertex : b.vertices) a.vertices.push_back(vertex + shift);
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  return a;
}

TEST(CheckMesh, ABoxIsASolid) {
  const MeshCheck check = checkMesh(models::makeBox({2, 3, 5}));
  EXPECT_EQ(check.vertices, 8U);
  EXPECT_EQ(check.triangles, 12U);
  EXPECT_EQ(check.components, 1U);
  EXPECT_EQ(check.boundaryEdges + check.nonManifoldEdges + check.misorientedEdges + check.nonManifoldVertices,
            0U);
  EXPECT_EQ(check.selfIntersections, 0U);
  EXPECT_TRUE(check.closed && check.manifold && check.oriented);
  EXPECT_EQ(check.genus, 0);
  EXPECT_DOUBLE_EQ(check.area, 62);
  EXPECT_DOUBLE_EQ(check.volume, 30);
  EXPECT_EQ(check.bounds.max(), Vector3d(1, 1.5, 2.5));
}

TEST(CheckMesh, GenusCountsHandlesOverAllComponents) {
  EXPECT_EQ(checkMesh(models::makeBall(1, 2)).genus, 0);
  const TriangleMesh torus = models::makeTorus(2, 0.5, 24, 12);
  EXPECT_EQ(checkMesh(torus).genus, 1);
  const MeshCheck two = checkMesh(joined(torus, torus, {10, 0, 0}));
  EXPECT_EQ(two.components, 2U);
  EXPECT_EQ(two.genus, 2);
  EXPECT_EQ(two.selfIntersections, 0U);
}

TEST(CheckMesh, AMissingTriangleOpensThreeEdges) {
  TriangleMesh mesh = models::makeBox({1, 1, 1});
  mesh.triangles.pop_back();
  const MeshCheck check = checkMesh(mesh);
  EXPECT_EQ(check.boundaryEdges, 3U);
  EXPECT_FALSE(check.closed);
  EXPECT_TRUE(check.manifold && check.oriented);
  EXPECT_FALSE(check.genus.has_value());
}

TEST(CheckMesh, AFlippedTriangleDisagreesOverThreeEdges) {
  TriangleMesh mesh = models::makeBox({1, 1, 1});
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  const MeshCheck check = checkMesh(mesh);
  EXPECT_EQ(check.misorientedEdges, 3U);
  EXPECT_FALSE(check.oriented);
  EXPECT_TRUE(check.closed && check.manifold);
}

TEST(CheckMesh, AFinMakesOneEdgeCrowded) {
  TriangleMesh mesh = models::makeBox({1, 1, 1});
  const auto& t = mesh.triangles[0];
  mesh.vertices.emplace_back(3, 4, 5);
  mesh.triangles.push_back({t[0], t[1], 8});
  const MeshCheck check = checkMesh(mesh);
  EXPECT_EQ(check.nonManifoldEdges, 1U);
  EXPECT_EQ(check.boundaryEdges, 2U);
  EXPECT_FALSE(check.manifold);
}

TEST(CheckMesh, BallsThatShareAVertexMeetInTwoFans) {
  const MeshCheck check = checkMesh(models::makeTangentBalls(1, 2));
  EXPECT_EQ(check.components, 1U);
  EXPECT_EQ(check.nonManifoldVertices, 1U);
  EXPECT_EQ(check.nonManifoldEdges, 0U);
  EXPECT_TRUE(check.closed && check.oriented);
  EXPECT_FALSE(check.manifold);
  EXPECT_FALSE(check.genus.has_value());
}

TEST(CheckMesh, CrossingTrianglesAreCountedAsPairs) {
  TriangleMesh cross;
  cross.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0.1, 0, 1}, {-0.1, 0, 1}};
  cross.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(checkMesh(cross).selfIntersections, 1U);
  cross.vertices[3].z() = 0.5;
  EXPECT_EQ(checkMesh(cross).selfIntersections, 0U);
}

TEST(CheckMesh, NeighboursIntersectOnlyWhenTheyOverlap) {
  TriangleMesh fold;  // two triangles over one edge
  fold.triangles = {{0, 1, 2}, {1, 0, 3}};
  fold.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  EXPECT_EQ(checkMesh(fold).selfIntersections, 0U);
  fold.vertices[3] = {0.5, 2, 1e-9};
  EXPECT_EQ(checkMesh(fold).selfIntersections, 0U) << "a sharp fold is none";
  fold.vertices[3] = {0.5, 2, 0};
  EXPECT_EQ(checkMesh(fold).selfIntersections, 1U) << "folded flat";

  TriangleMesh touch;  // two triangles over one vertex
  touch.triangles = {{0, 1, 2}, {0, 3, 4}};
  touch.vertices = {{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {1, 0, 1}, {1, 0, 2}};
  EXPECT_EQ(checkMesh(touch).selfIntersections, 0U);
  touch.vertices[4] = {1, 0, -1};
  EXPECT_EQ(checkMesh(touch).selfIntersections, 1U);

  TriangleMesh twice = models::makeBox({1, 1, 1});
  twice.triangles.push_back({twice.triangles[0][1], twice.triangles[0][0], twice.triangles[0][2]});
  EXPECT_GE(checkMesh(twice).selfIntersections, 1U) << "the same triangle from behind";
}

TEST(CheckMesh, TwoBoxesThatOverlapCrossAlongTheRim) {
  const TriangleMesh boxes = joined(models::makeBox({1, 1, 1}), models::makeBox({1, 1, 1}), {0.5, 0.4, 0.3});
  const MeshCheck check = checkMesh(boxes);
  EXPECT_GT(check.selfIntersections, 0U);
  EXPECT_EQ(check.components, 2U);
  EXPECT_TRUE(check.closed && check.manifold && check.oriented);
  EXPECT_DOUBLE_EQ(check.volume, 2);
}

TEST(CheckMesh, AnEndlessCountIsCutShortAndSaysSo) {
  // All sides of a cone overlap, as boxes do, at its tip: n (n - 1) / 2 pairs.
  const MeshCheck few = checkMesh(models::makeCone(1, 1, 1000));
  EXPECT_EQ(few.selfIntersections, 0U);
  EXPECT_TRUE(few.allSelfIntersections);
  const MeshCheck many = checkMesh(models::makeCone(1, 1, 6000));
  EXPECT_FALSE(many.allSelfIntersections);
  EXPECT_TRUE(many.closed && many.manifold && many.oriented);
}

TEST(CheckMesh, TurningTheMeshTellsTheSameStory) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const TriangleMesh ball = models::makeBall(1, 3);
  const std::size_t crossings = checkMesh(joined(ball, ball, {0.713, 0.211, 0.119})).selfIntersections;
  EXPECT_GT(crossings, 0U);
  for (int round = 0; round < 3; ++round) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), uniform(random)).normalized();
    SCOPED_TRACE(turn.coeffs().transpose());
    TriangleMesh turned = joined(ball, ball, {0.713, 0.211, 0.119});
    for (Vector3d& vertex : turned.vertices) vertex = turn * vertex + Vector3d(3, 5, 7);
    EXPECT_EQ(checkMesh(turned).selfIntersections, crossings);
  }
}

TEST(CheckMesh, UnusedVerticesAndTrianglesWithoutAreaDoNoHarm) {
  TriangleMesh mesh = models::makeBox({1, 1, 1});
  mesh.vertices.emplace_back(100, 100, 100);
  mesh.triangles.push_back({0, 0, 1});
  const MeshCheck check = checkMesh(mesh);
  EXPECT_EQ(check.vertices, 8U);
  EXPECT_EQ(check.bounds.max(), Vector3d(0.5, 0.5, 0.5));
  EXPECT_EQ(check.selfIntersections, 0U);
  EXPECT_EQ(checkMesh({}).triangles, 0U);
}

}  // namespace
}  // namespace spheretree::io
