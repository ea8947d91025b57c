// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/mesh_write.hpp"

#include <cmath>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh_import.hpp"
#include "models/shapes.hpp"
#include "test_folder.hpp"

namespace spheretree::io {
namespace {

using medial::TriangleMesh;

/// Through memory: g++ 12 at -O2 vectorises a conversion to float and back into nothing.
double asFloat(double value) {
  volatile float rounded = static_cast<float>(value);
  return static_cast<double>(rounded);
}

class MeshWrite : public tests::InFolder {
 protected:
  /// A ball whose coordinates use all bits of a double and all magnitudes.
  static TriangleMesh awkwardBall() {
    TriangleMesh mesh = models::makeBall(1, 2);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.9, 1.1);
    for (Eigen::Vector3d& vertex : mesh.vertices)
      vertex = vertex * uniform(random) + Eigen::Vector3d(1e-7, 1.0 / 3, 12345.678);
    mesh.vertices[0] *= 1e-5;
    return mesh;
  }
};

TEST_F(MeshWrite, ObjOffAndPlyReadBackBitForBit) {
  const TriangleMesh mesh = awkwardBall();
  for (const std::string name : {"a.obj", "a.off", "a.ply", "a.OBJ"}) {
    SCOPED_TRACE(name);
    ASSERT_TRUE(writeMesh(in(name), mesh, Overwrite::Replace).ok());
    const Result<ImportedMesh> read = importMesh(in(name));
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read.value().mesh.triangles, mesh.triangles);
    EXPECT_EQ(read.value().mesh.vertices, mesh.vertices);
  }
}

TEST_F(MeshWrite, StlReadsBackAsFloats) {
  const TriangleMesh mesh = models::makeTorus(2, 0.5, 16, 8);
  ASSERT_TRUE(writeMesh(in("a.stl"), mesh, Overwrite::Refuse).ok());
  const Result<ImportedMesh> read = importMesh(in("a.stl"));
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read.value().mesh.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d expected = mesh.corner(t, k).unaryExpr(&asFloat);
      EXPECT_EQ(read.value().mesh.corner(t, k), expected);
    }
  }
}

TEST_F(MeshWrite, UnknownEndingsAndExistingFilesAreRefused) {
  const TriangleMesh mesh = models::makeBox({1, 1, 1});
  for (const std::string name : {"a.dae", "a"}) {
    const Result<Done> written = writeMesh(in(name), mesh, Overwrite::Refuse);
    ASSERT_FALSE(written.ok());
    EXPECT_EQ(written.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(written.error().message, testing::StartsWith(in(name).string() + ": "));
  }
  put("a.obj", "mine");
  const Result<Done> written = writeMesh(in("a.obj"), mesh, Overwrite::Refuse);
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::UnwritableOutput);
  EXPECT_EQ(contentOf(in("a.obj")), "mine");
}

}  // namespace
}  // namespace spheretree::io
