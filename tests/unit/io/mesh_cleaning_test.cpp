// SPDX-License-Identifier: GPL-3.0-or-later
//
// From polygons to triangles: what is welded, cut, dropped and counted.
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/mesh_check.hpp"
#include "io/mesh_import.hpp"
#include "io/soup_cleaning.hpp"
#include "medial/triangle_mesh.hpp"
#include "models/shapes.hpp"
#include "test_folder.hpp"

namespace spheretree::io {
namespace {

using Eigen::Vector3d;
using medial::TriangleMesh;
using Triangle = TriangleMesh::Triangle;

double areaOfCut(const std::vector<Vector3d>& points, const std::vector<Triangle>& triangles) {
  return medial::areaOf({points, triangles});
}

std::vector<std::uint32_t> countTo(std::size_t count) {
  std::vector<std::uint32_t> numbers(count);
  for (std::uint32_t i = 0; i < count; ++i) numbers[i] = i;
  return numbers;
}

TEST(TriangulatePolygon, CutsANotchedQuadrilateralInside) {
  // An arrowhead: only the diagonal through the notch lies inside. Area 2 * 2 / 2 - 2 * 1 / 2 = 1.
  const std::vector<Vector3d> arrow = {{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {1, 2, 0}};
  for (std::uint32_t turn = 0; turn < 4; ++turn) {
    std::vector<std::uint32_t> corners = countTo(4);
    for (std::uint32_t& corner : corners) corner = (corner + turn) % 4;
    const std::vector<Triangle> triangles = triangulatePolygon(arrow, corners);
    ASSERT_EQ(triangles.size(), 2U);
    EXPECT_DOUBLE_EQ(areaOfCut(arrow, triangles), 1) << "turned by " << turn;
  }
}

TEST(TriangulatePolygon, CutsAStarOfAnySizeAndAttitude) {
  // Spikes between radius 1 and 0.4: area n * 1 * 0.4 * sin(pi / n). A fan from a corner would leave it.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const std::size_t spikes : {3U, 5U, 12U, 1000U}) {
    SCOPED_TRACE(spikes);
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), uniform(random)).normalized();
    std::vector<Vector3d> star;
    for (std::size_t k = 0; k < 2 * spikes; ++k) {
      const double angle = std::numbers::pi * static_cast<double>(k) / static_cast<double>(spikes);
      const double radius = k % 2 == 0 ? 1 : 0.4;
      star.push_back(turn * Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0));
    }
    const std::vector<Triangle> triangles = triangulatePolygon(star, countTo(star.size()));
    ASSERT_EQ(triangles.size(), 2 * spikes - 2);
    const double count = static_cast<double>(spikes);
    EXPECT_NEAR(areaOfCut(star, triangles), count * 0.4 * std::sin(std::numbers::pi / count), 1e-9);
    for (const Triangle& t : triangles) {
      const Vector3d normal = (star[t[1]] - star[t[0]]).cross(star[t[2]] - star[t[0]]);
      EXPECT_GT(normal.dot(turn * Vector3d::UnitZ()), 0) << "same orientation as the polygon";
    }
  }
}

TEST(TriangulatePolygon, GivesSomethingForAPolygonThatCrossesItself) {
  const std::vector<Vector3d> bow = {{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}, {-1, 1, 0}};
  EXPECT_EQ(triangulatePolygon(bow, countTo(5)).size(), 3U);
}

TEST(Welding, JoinsEqualPositionsOnlyAndDropsUnusedVertices) {
  TriangleMesh mesh;
  mesh.vertices = {
      {9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}, {0, 1, 0}, {0, 0, std::nextafter(0, 1)}};
  mesh.triangles = {{1, 2, 3}, {4, 5, 6}};
  const TriangleMesh welded = weldVertices(mesh);
  ASSERT_EQ(welded.vertices.size(), 4U);
  EXPECT_EQ(welded.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(welded.triangles[1], (Triangle{0, 2, 3}));
  EXPECT_FALSE(std::signbit(weldVertices({{{-0.0, 0, 0}}, {{0, 0, 0}}}).vertices[0].x()));
}

TEST(RemoveDuplicates, KeepsTheFirstOfEachOrientation) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{1, 2, 0}, {0, 2, 1}, {0, 1, 2}, {2, 1, 0}, {2, 0, 1}};
  EXPECT_EQ(removeDuplicates(mesh), 3U);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{1, 2, 0}, {0, 2, 1}}));
}

TEST(RemoveDegenerate, ASliverBetweenTwoTrianglesLeavesAClosedMesh) {
  // The box's first edge is broken at its middle on one side only; a triangle without area closes the gap.
  TriangleMesh mesh = models::makeBox({2, 3, 5});
  const Triangle first = mesh.triangles[0];
  const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back((mesh.vertices[first[0]] + mesh.vertices[first[1]]) / 2);
  mesh.triangles[0] = {first[0], middle, first[2]};
  mesh.triangles.push_back({middle, first[1], first[2]});
  mesh.triangles.push_back({first[0], first[1], middle});
  ASSERT_TRUE(medial::boundsVolume(mesh));

  EXPECT_EQ(removeDegenerate(mesh), 1U);
  EXPECT_EQ(mesh.triangles.size(), 14U);
  EXPECT_TRUE(medial::boundsVolume(mesh));
  EXPECT_DOUBLE_EQ(medial::signedVolumeOf(mesh), 30);
  EXPECT_DOUBLE_EQ(medial::areaOf(mesh), 62);
  EXPECT_EQ(checkMesh(mesh).selfIntersections, 0U);
}

TEST(RemoveDegenerate, ACrowdAroundAnEdgeFullOfSliversDoesNotMultiply) {
  // Each of the 255 slivers in the common edge would split all 256 triangles around it.
  constexpr std::uint32_t kParts = 256;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= kParts; ++i) mesh.vertices.emplace_back(i, 0, 0);
  for (std::uint32_t step = kParts; step > 1; step /= 2) {
    for (std::uint32_t low = 0; low < kParts; low += step)
      mesh.triangles.push_back({low, low + step / 2, low + step});
  }
  const std::size_t slivers = mesh.triangles.size();
  for (std::uint32_t k = 0; k < kParts; ++k) {
    const double angle = 2 * std::numbers::pi * k / kParts;
    mesh.triangles.push_back({0, kParts, static_cast<std::uint32_t>(mesh.vertices.size())});
    mesh.vertices.emplace_back(1, std::cos(angle), std::sin(angle));
  }
  const std::size_t before = mesh.triangles.size();
  EXPECT_EQ(removeDegenerate(mesh), slivers);
  EXPECT_LE(mesh.triangles.size(), 4 * before);
  EXPECT_GE(mesh.triangles.size(), std::size_t{kParts});
}

TEST(RemoveDegenerate, AStackOfSliversGoesToo) {
  // Three vertices on one edge, tied to it by a chain of slivers.
  TriangleMesh mesh = models::makeBox({4, 3, 5});
  const Triangle first = mesh.triangles[0];
  const Vector3d from = mesh.vertices[first[0]];
  const Vector3d step = (mesh.vertices[first[1]] - from) / 4;
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int k = 1; k <= 3; ++k) mesh.vertices.push_back(from + k * step);
  mesh.triangles[0] = {first[0], base, first[2]};
  for (const Triangle& t : {Triangle{base, base + 1, first[2]}, Triangle{base + 1, base + 2, first[2]},
                            Triangle{base + 2, first[1], first[2]}, Triangle{first[0], first[1], base},
                            Triangle{base, first[1], base + 1}, Triangle{base + 1, first[1], base + 2}})
    mesh.triangles.push_back(t);
  ASSERT_TRUE(medial::boundsVolume(mesh));

  EXPECT_EQ(removeDegenerate(mesh), 3U);
  EXPECT_TRUE(medial::boundsVolume(mesh));
  EXPECT_NEAR(medial::signedVolumeOf(mesh), 60, 1e-12);
  EXPECT_NEAR(medial::areaOf(mesh), 94, 1e-12);
}

class Cleaning : public tests::InFolder {};

TEST_F(Cleaning, EverythingIsCounted) {
  // A unit square as one polygon, split vertices, its copy, its back, a needle, a point and a face of two
  // corners.
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"  // 1-4
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"  // 5-8, the same places
      "v 7 7 7\n"                             // unused
      "f 1 2 3 4\nf 5 6 7 8\nf 4 3 2 1\nf 1 2 6\nf 1 5 2 3\nf 1 2\n";
  const Result<ImportedMesh> imported = importMesh(put("a.obj", text));
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  const ImportReport& report = imported.value().report;
  EXPECT_EQ(report.polygons, 6U);
  EXPECT_EQ(report.triangulated, 4U);
  EXPECT_EQ(report.weldedVertices, 4U);
  EXPECT_EQ(report.degenerateTriangles, 3U);  // the needle, one of (1 5 2 3), the face of two
  EXPECT_EQ(report.duplicateTriangles, 3U);   // two of the copy, one of (1 5 2 3)
  EXPECT_EQ(imported.value().mesh.triangles.size(), 4U);
  EXPECT_EQ(imported.value().mesh.vertices.size(), 4U);
}

}  // namespace
}  // namespace spheretree::io
