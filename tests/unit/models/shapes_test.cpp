// SPDX-License-Identifier: GPL-3.0-or-later
#include "models/shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "topology.hpp"

namespace spheretree::models {
namespace {

using Eigen::Vector3d;
using medial::boundsOf;
using medial::signedVolumeOf;
using tests::hasValidIndices;
using tests::Topology;
using tests::topologyOf;

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-12;  // relative; the sums have at most a few thousand terms

void expectSolid(const TriangleMesh& mesh, long euler) {
  ASSERT_TRUE(hasValidIndices(mesh));
  const Topology topology = topologyOf(mesh);
  EXPECT_EQ(topology.unbalancedEdges, 0U);
  EXPECT_EQ(topology.crowdedEdges, 0U);
  EXPECT_EQ(topology.euler(), euler);
  EXPECT_EQ(topology.vertices, mesh.vertices.size()) << "every vertex is used";
}

void expectVolume(const TriangleMesh& mesh, double expected) {
  EXPECT_NEAR(signedVolumeOf(mesh), expected, kRounding * expected);
}

TEST(Ball, IsASphereOfTheRightSize) {
  for (std::uint32_t subdivisions = 0; subdivisions < 5; ++subdivisions) {
    SCOPED_TRACE(subdivisions);
    const TriangleMesh mesh = makeBall(1, subdivisions);
    expectSolid(mesh, 2);
    EXPECT_EQ(mesh.triangles.size(), 20U << (2 * subdivisions));
  }
}

TEST(Ball, VerticesLieOnTheBall) {
  for (const double radius : {1e-3, 1.0, 7.5}) {
    for (const Vector3d& vertex : makeBall(radius, 4).vertices) {
      ASSERT_NEAR(vertex.norm() / radius, 1, 1e-15);
    }
  }
}

TEST(Ball, HasVerticesOnTheCoordinateAxes) {
  const TriangleMesh mesh = makeBall(2, 1);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-2.0, 2.0}) {
      const Vector3d pole = side * Vector3d::Unit(axis);
      EXPECT_EQ(std::count(mesh.vertices.begin(), mesh.vertices.end(), pole), 1) << pole.transpose();
    }
  }
}

TEST(Ball, VolumeConvergesFromBelowWithTheSquareOfTheEdge) {
  const double ball = 4 * kPi / 3;
  EXPECT_NEAR(signedVolumeOf(makeBall(1, 0)), 2.0 / 3 * std::sqrt(10 + 2 * std::sqrt(5.0)), kRounding);
  double missing = ball - signedVolumeOf(makeBall(1, 2));
  for (std::uint32_t subdivisions = 3; subdivisions < 6; ++subdivisions) {
    const double next = ball - signedVolumeOf(makeBall(1, subdivisions));
    EXPECT_GT(next, 0) << "inscribed, so smaller than the ball";
    EXPECT_NEAR(missing / next, 4, 0.1) << subdivisions;
    missing = next;
  }
  EXPECT_LT(missing, 1e-3 * ball);
}

TEST(Ball, TrianglesFaceOutwards) {
  const TriangleMesh mesh = makeBall(1, 2);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d a = mesh.corner(t, 0);
    ASSERT_GT((mesh.corner(t, 1) - a).cross(mesh.corner(t, 2) - a).dot(a), 0) << t;
  }
}

TEST(Box, HasTwelveTrianglesAndItsOwnCorners) {
  const Vector3d size(3, 0.5, 7);
  const TriangleMesh mesh = makeBox(size);
  expectSolid(mesh, 2);
  expectVolume(mesh, size.prod());
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_EQ(mesh.vertices.size(), 8U);
  for (const Vector3d& vertex : mesh.vertices) EXPECT_EQ(vertex.cwiseAbs(), size / 2);
}

TEST(Cylinder, IsAPrismOverARegularPolygon) {
  for (const std::uint32_t segments : {3U, 4U, 17U, 64U}) {
    SCOPED_TRACE(segments);
    const TriangleMesh mesh = makeCylinder(2, 5, segments);
    expectSolid(mesh, 2);
    expectVolume(mesh, 5 * 0.5 * segments * 4 * std::sin(2 * kPi / segments));
    EXPECT_EQ(mesh.triangles.size(), 4 * segments);
    EXPECT_EQ(boundsOf(mesh).min().z(), -2.5);
    EXPECT_EQ(boundsOf(mesh).max().z(), 2.5);
  }
}

TEST(Cone, HasAThirdOfThePrism) {
  for (const std::uint32_t segments : {3U, 16U}) {
    SCOPED_TRACE(segments);
    const TriangleMesh mesh = makeCone(2, 5, segments);
    expectSolid(mesh, 2);
    expectVolume(mesh, 5.0 / 3 * 0.5 * segments * 4 * std::sin(2 * kPi / segments));
  }
}

TEST(Torus, IsARingOfKnownVolume) {
  struct Resolution {
    std::uint32_t segments, sides;
  };
  for (const auto [segments, sides] : {Resolution{3, 3}, Resolution{8, 5}, Resolution{36, 16}}) {
    SCOPED_TRACE(segments);
    const TriangleMesh mesh = makeTorus(3, 1, segments, sides);
    expectSolid(mesh, 0);
    // The cross-section is a regular polygon; a wedge of angle a sweeps its area times 3 sin(a).
    const double polygon = 0.5 * sides * std::sin(2 * kPi / sides);
    expectVolume(mesh, polygon * 3 * segments * std::sin(2 * kPi / segments));
    EXPECT_EQ(mesh.triangles.size(), 2 * segments * sides);
  }
}

TEST(Torus, ApproachesPappus) {
  const double smooth = 2 * kPi * 3 * kPi;
  const double coarse = smooth - signedVolumeOf(makeTorus(3, 1, 24, 24));
  const double fine = smooth - signedVolumeOf(makeTorus(3, 1, 48, 48));
  EXPECT_GT(fine, 0);
  EXPECT_NEAR(coarse / fine, 4, 0.1);
}

TEST(ThinSolids, AreAsThinAsTheySay) {
  expectSolid(makeSlab(), 2);
  expectVolume(makeSlab(), 1e-3);
  EXPECT_TRUE(boundsOf(makeSlab()).sizes().isApprox(Vector3d(1, 1, 1e-3)));
  expectSolid(makeNeedle(), 2);
  expectVolume(makeNeedle(), 1e-6);
  EXPECT_TRUE(boundsOf(makeNeedle()).sizes().isApprox(Vector3d(1, 1e-3, 1e-3)));
}

TEST(Blocks, AreMadeOfUnitCubes) {
  expectSolid(makeLBlock(), 2);
  expectVolume(makeLBlock(), 3);
  EXPECT_EQ(boundsOf(makeLBlock()).sizes(), Vector3d(2, 2, 1));
  expectSolid(makeUBlock(), 2);
  expectVolume(makeUBlock(), 5);
  EXPECT_EQ(boundsOf(makeUBlock()).sizes(), Vector3d(3, 2, 1));
  EXPECT_EQ(medial::areaOf(makeLBlock()), 14);
  EXPECT_EQ(medial::areaOf(makeUBlock()), 22);
}

TEST(Comb, GrowsByFivePerTooth) {
  for (const std::uint32_t teeth : {1U, 2U, 9U}) {
    SCOPED_TRACE(teeth);
    const TriangleMesh mesh = makeComb(teeth);
    expectSolid(mesh, 2);
    expectVolume(mesh, 5.0 * teeth - 1);
    EXPECT_EQ(boundsOf(mesh).sizes(), Vector3d(2.0 * teeth - 1, 4, 1));
  }
}

TEST(HollowBall, IsTheDifferenceOfTwoBalls) {
  const TriangleMesh mesh = makeHollowBall(2, 1.5, 2);
  expectSolid(mesh, 4);  // two spheres
  EXPECT_EQ(topologyOf(mesh).shells, 2U);
  expectVolume(mesh, signedVolumeOf(makeBall(1, 2)) * (8 - 1.5 * 1.5 * 1.5));
}

TEST(TangentBalls, ShareOneVertexAndNothingElse) {
  const TriangleMesh mesh = makeTangentBalls(0.5, 2);
  expectSolid(mesh, 3);  // two spheres, one vertex in common
  EXPECT_EQ(topologyOf(mesh).shells, 2U);
  expectVolume(mesh, 2 * signedVolumeOf(makeBall(0.5, 2)));
  const auto origin = std::find(mesh.vertices.begin(), mesh.vertices.end(), Vector3d::Zero());
  ASSERT_NE(origin, mesh.vertices.end());
  const auto shared = static_cast<std::uint32_t>(origin - mesh.vertices.begin());
  std::set<bool> sides;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const bool right = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)).x() > 0;
    if (std::count(mesh.triangles[t].begin(), mesh.triangles[t].end(), shared) > 0) sides.insert(right);
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = mesh.corner(t, k).x();
      ASSERT_TRUE(right ? x >= 0 : x <= 0) << "a triangle that reaches into the other ball";
    }
  }
  EXPECT_EQ(sides.size(), 2U);
}

TEST(Gear, IsAPlateWithABore) {
  for (const std::uint32_t teeth : {3U, 12U, 30U}) {
    SCOPED_TRACE(teeth);
    const TriangleMesh mesh = makeGear(teeth);
    expectSolid(mesh, 0);
    // Triangles between consecutive radii 0.8, 0.8, 1, 1 all around, minus the polygonal bore.
    const double sine = std::sin(2 * kPi / (4 * teeth));
    const double star = 0.5 * teeth * sine * (0.8 * 0.8 + 0.8 + 1 + 0.8);
    const double bore = 0.5 * 4 * teeth * sine * 0.3 * 0.3;
    expectVolume(mesh, 0.4 * (star - bore));
  }
}

TEST(Knot, ApproachesATubeOfConstantSection) {
  const auto curve = [](double t) {
    const double reach = 2 + std::cos(3 * t);
    return Vector3d(reach * std::cos(2 * t), reach * std::sin(2 * t), std::sin(3 * t));
  };
  constexpr int kSteps = 20000;
  double length = 0;
  for (int i = 0; i < kSteps; ++i) {
    length += (curve(2 * kPi * (i + 1) / kSteps) - curve(2 * kPi * i / kSteps)).norm();
  }
  const double smooth = kPi * 0.35 * 0.35 * length;  // Pappus: the section's centre runs on the curve
  expectSolid(makeKnot(94, 8), 0);
  EXPECT_EQ(makeKnot(94, 8).triangles.size(), 1504U);
  const double coarse = std::abs(smooth - signedVolumeOf(makeKnot(200, 24)));
  const double fine = std::abs(smooth - signedVolumeOf(makeKnot(400, 48)));
  EXPECT_LT(fine, 0.005 * smooth);
  EXPECT_NEAR(coarse / fine, 4, 0.2);
}

TEST(Knot, StrandsKeepClearOfEachOther) {
  // Tube radius 0.35: centre lines that are far apart along the knot must stay more than 0.7 apart in space.
  constexpr int kSteps = 600;
  const auto centre = [](int i) {
    const double t = 2 * kPi * i / kSteps;
    const double reach = 2 + std::cos(3 * t);
    return Vector3d(reach * std::cos(2 * t), reach * std::sin(2 * t), std::sin(3 * t));
  };
  double closest = 10;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = i + kSteps / 10; j < kSteps && j - i <= kSteps - kSteps / 10; ++j) {
      closest = std::min(closest, (centre(i) - centre(j)).norm());
    }
  }
  EXPECT_GT(closest, 1.2);
}

}  // namespace
}  // namespace spheretree::models
