// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/mesh_simplify.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "io/mesh_check.hpp"
#include "models/shapes.hpp"

namespace spheretree::io {
namespace {

using medial::TriangleMesh;

TEST(SimplifyMesh, ABallStaysABall) {
  const TriangleMesh ball = models::makeBall(1, 5);  // 20480 triangles
  for (const std::size_t wanted : {5000U, 501U, 100U}) {
    SCOPED_TRACE(wanted);
    const Result<TriangleMesh> simple = simplifyMesh(ball, wanted);
    ASSERT_TRUE(simple.ok()) << simple.error().message;
    const MeshCheck check = checkMesh(simple.value());
    EXPECT_LE(check.triangles, wanted);
    EXPECT_GE(check.triangles, wanted - 3);
    EXPECT_TRUE(check.closed && check.manifold && check.oriented);
    EXPECT_EQ(check.genus, 0);
    EXPECT_EQ(check.selfIntersections, 0U);
    // Flat triangles of a ball of n of them lose about 4 pi / (sqrt(3) n) of the radius at their middle.
    const double sag = 4 * std::numbers::pi / (std::sqrt(3.0) * static_cast<double>(wanted));
    EXPECT_NEAR(check.volume, 4 * std::numbers::pi / 3, 4 * std::numbers::pi * 2 * sag);
    for (const Eigen::Vector3d& vertex : simple.value().vertices) EXPECT_NEAR(vertex.norm(), 1, 3 * sag);
  }
}

TEST(SimplifyMesh, FlatFacesCostNothing) {
  // Every face of a box cut into 2 * 8 * 8 triangles; with 12 of them left it must be the box again.
  TriangleMesh grid;
  constexpr std::uint32_t kCells = 8;
  TriangleMesh box = models::makeBox({2, 3, 5});
  for (const auto& t : box.triangles) {
    const Eigen::Vector3d a = box.vertices[t[0]], b = box.vertices[t[1]], c = box.vertices[t[2]];
    const auto at = [&](std::uint32_t i, std::uint32_t j) {
      return a + (b - a) * (double{1} * i / kCells) + (c - a) * (double{1} * j / kCells);
    };
    const auto vertex = [&](const Eigen::Vector3d& p) {
      for (std::uint32_t v = 0; v < grid.vertices.size(); ++v)
        if ((grid.vertices[v] - p).norm() < 1e-9) return v;
      grid.vertices.push_back(p);
      return static_cast<std::uint32_t>(grid.vertices.size() - 1);
    };
    for (std::uint32_t i = 0; i < kCells; ++i) {
      for (std::uint32_t j = 0; i + j < kCells; ++j) {
        grid.triangles.push_back({vertex(at(i, j)), vertex(at(i + 1, j)), vertex(at(i, j + 1))});
        if (i + j + 1 < kCells)
          grid.triangles.push_back({vertex(at(i + 1, j)), vertex(at(i + 1, j + 1)), vertex(at(i, j + 1))});
      }
    }
  }
  ASSERT_TRUE(medial::boundsVolume(grid));
  const Result<TriangleMesh> simple = simplifyMesh(grid, 12);
  ASSERT_TRUE(simple.ok()) << simple.error().message;
  EXPECT_EQ(simple.value().triangles.size(), 12U);
  EXPECT_TRUE(medial::boundsVolume(simple.value()));
  EXPECT_NEAR(medial::signedVolumeOf(simple.value()), 30, 1e-6);
}

TEST(SimplifyMesh, KeepsHandlesAndComponents) {
  const TriangleMesh torus = models::makeTorus(2, 0.5, 100, 50);
  const Result<TriangleMesh> simple = simplifyMesh(torus, 300);
  ASSERT_TRUE(simple.ok());
  const MeshCheck check = checkMesh(simple.value());
  EXPECT_LE(check.triangles, 300U);
  EXPECT_EQ(check.genus, 1);
  EXPECT_EQ(check.components, 1U);
  EXPECT_EQ(check.selfIntersections, 0U);
  const Result<TriangleMesh> hollow = simplifyMesh(models::makeHollowBall(2, 1, 3), 400);
  ASSERT_TRUE(hollow.ok());
  EXPECT_EQ(checkMesh(hollow.value()).components, 2U);
}

TEST(SimplifyMesh, IsTheSameEveryTimeAndFarFromTheOrigin) {
  const TriangleMesh knot = models::makeKnot(120, 16);
  const Result<TriangleMesh> first = simplifyMesh(knot, 800);
  const Result<TriangleMesh> second = simplifyMesh(knot, 800);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first.value().triangles, second.value().triangles);
  EXPECT_EQ(first.value().vertices, second.value().vertices);

  TriangleMesh far = knot;
  for (Eigen::Vector3d& vertex : far.vertices) vertex += Eigen::Vector3d::Constant(1048576);
  const Result<TriangleMesh> moved = simplifyMesh(far, 800);
  ASSERT_TRUE(moved.ok());
  EXPECT_NEAR(medial::signedVolumeOf(moved.value()) / medial::signedVolumeOf(first.value()), 1, 0.01);
}

TEST(SimplifyMesh, LeavesWhatIsSmallAndRefusesWhatIsOpen) {
  TriangleMesh box = models::makeBox({1, 1, 1});
  EXPECT_EQ(simplifyMesh(box, 12).value().triangles, box.triangles);
  EXPECT_EQ(simplifyMesh(box, 3).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(simplifyMesh(models::makeTangentBalls(1, 2), 100).error().code, ErrorCode::UnsuitableMesh);
  box.triangles.pop_back();
  EXPECT_EQ(simplifyMesh(box, 4).error().code, ErrorCode::UnsuitableMesh);
  EXPECT_EQ(simplifyMesh({}, 4).error().code, ErrorCode::UnsuitableMesh);
}

}  // namespace
}  // namespace spheretree::io
