// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/canonical_frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "medial/random.hpp"
#include "models/shapes.hpp"

namespace spheretree::medial {
namespace {

/// The same solid with its vertices and triangles in random order, triangles beginning anywhere.
TriangleMesh shuffled(const TriangleMesh& mesh, Random& random) {
  TriangleMesh result = mesh;
  std::vector<std::uint32_t> place(mesh.vertices.size());
  for (std::uint32_t v = 0; v < place.size(); ++v) place[v] = v;
  for (std::size_t i = place.size(); i > 1; --i) std::swap(place[i - 1], place[random.next() % i]);
  for (std::size_t v = 0; v < place.size(); ++v) result.vertices[place[v]] = mesh.vertices[v];
  for (auto& triangle : result.triangles) {
    for (std::uint32_t& corner : triangle) corner = place[corner];
    std::rotate(triangle.begin(), triangle.begin() + static_cast<std::ptrdiff_t>(random.next() % 3),
                triangle.end());
  }
  for (std::size_t i = result.triangles.size(); i > 1; --i)
    std::swap(result.triangles[i - 1], result.triangles[random.next() % i]);
  return result;
}

TEST(CanonicalFrame, TheOrderOfTheFileDoesNotMatter) {
  for (const models::Model& model : models::allModels()) {
    SCOPED_TRACE(std::string(model.name));
    if (model.name == "box_unwelded") continue;  // vertices at one place have no order
    const TriangleMesh mesh = model.make();
    const CanonicalFrame frame = canonicalFrame(mesh);
    const TriangleMesh expected = toFrame(mesh, frame, Places::Snapped);
    Random random(21);
    for (int run = 0; run < 3; ++run) {
      const TriangleMesh other = shuffled(mesh, random);
      const CanonicalFrame otherFrame = canonicalFrame(other);
      EXPECT_EQ(otherFrame.axes, frame.axes);
      EXPECT_EQ(otherFrame.origin, frame.origin);
      EXPECT_EQ(otherFrame.scale, frame.scale);
      const TriangleMesh moved = toFrame(other, otherFrame, Places::Snapped);
      EXPECT_EQ(moved.vertices, expected.vertices);
      EXPECT_EQ(moved.triangles, expected.triangles);
    }
  }
}

TEST(CanonicalFrame, KeepsTheSolid) {
  const TriangleMesh mesh = models::makeLBlock();
  const CanonicalFrame frame = canonicalFrame(mesh);
  const TriangleMesh moved = toFrame(mesh, frame, Places::Exact);
  EXPECT_TRUE(boundsVolume(moved));
  EXPECT_NEAR(signedVolumeOf(moved) * std::pow(frame.scale, 3), 3, 1e-12);
  EXPECT_NEAR(areaOf(moved) * std::pow(frame.scale, 2), areaOf(mesh), 1e-12);
}

TEST(CanonicalFrame, IsARotationWhenAllLargeTrianglesFaceAlongOneAxis) {
  // The caps of a gear have all of the largest triangles; what is across them is rounding.
  for (std::uint32_t teeth = 3; teeth <= 24; ++teeth) {
    SCOPED_TRACE(std::to_string(teeth) + " teeth");
    const TriangleMesh gear = models::makeGear(teeth);
    for (const double angle : {0.0, 0.3, 1.1}) {
      TriangleMesh turned = gear;
      const Eigen::AngleAxisd turn(angle, Eigen::Vector3d(1, 2, 3).normalized());
      for (Eigen::Vector3d& v : turned.vertices) v = turn * v;
      const CanonicalFrame frame = canonicalFrame(turned);
      EXPECT_LT((frame.axes * frame.axes.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
      EXPECT_NEAR(frame.axes.determinant(), 1, 1e-9);
    }
  }
}

TEST(Measurable, FromTheSmallestToTheLargestSolidOfDoubles) {
  for (const double size : {1e-59, 1e-30, 1.0, 1e30, 1e59}) {
    TriangleMesh mesh = models::makeLBlock();
    for (Eigen::Vector3d& v : mesh.vertices) v *= size;
    EXPECT_EQ(whyNotMeasurable(mesh), "");
    EXPECT_NEAR(canonicalFrame(mesh).scale / size, canonicalFrame(models::makeLBlock()).scale, 1e-9);
  }
}

TEST(Measurable, NamesWhatIsBeyond) {
  const auto reason = [](double size) {
    TriangleMesh mesh = models::makeLBlock();
    for (Eigen::Vector3d& v : mesh.vertices) v *= size;
    return whyNotMeasurable(mesh);
  };
  EXPECT_NE(reason(1e160).find("too far"), std::string::npos) << reason(1e160);
  EXPECT_NE(reason(1e-160).find("too small"), std::string::npos) << reason(1e-160);
  EXPECT_NE(reason(5e-320).find("too small"), std::string::npos) << reason(5e-320);
}

}  // namespace
}  // namespace spheretree::medial
