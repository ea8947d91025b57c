// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mesh.hpp"
#include "overhang.hpp"
#include "tests/cli/program.hpp"

namespace crowded_room {
namespace {

using spheretree::Vec3;

class ObjFile : public spheretree::tests::ProgramTest {
 protected:
  spheretree::Result<Mesh> readMesh(const std::string& text) {
    write("mesh.obj", text);
    return readObj(folder_ / "mesh.obj");
  }
};

TEST_F(ObjFile, QuadsBecomeTwoTriangles) {
  const auto mesh = readMesh(spheretree::tests::boxObj());
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  EXPECT_EQ(mesh->vertices.size(), 8U);
  EXPECT_EQ(mesh->triangles.size(), 12U);
  for (const Mesh::Vertex& vertex : mesh->vertices)
    EXPECT_GT(dot(vertex.normal, vertex.place), 0.5F) << "normals of a box around the origin look outwards";
}

TEST_F(ObjFile, ReadsTexturesNormalsAndRelativeNumbers) {
  const auto mesh =
      readMesh("# a triangle\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf -3/1/1 -2/1/1 3//1\n");
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  ASSERT_EQ(mesh->triangles.size(), 1U);
  EXPECT_NEAR(mesh->vertices[0].normal.z, 1, 1e-6F);
}

TEST_F(ObjFile, NamesTheLineThatIsWrong) {
  for (const char* text : {"v 0 0 0\nf 1 2 3\n", "v 0 0\n", "v 0 0 0\nf 1 1\n", "v 0 0 0\nf a b c\n"}) {
    const auto mesh = readMesh(text);
    ASSERT_FALSE(mesh.ok()) << text;
    EXPECT_NE(mesh.error().message.find("mesh.obj: line "), std::string::npos) << mesh.error().message;
  }
  EXPECT_FALSE(readMesh("v 0 0 0\n").ok()) << "no faces, nothing to draw";
}

TEST(BoxMesh, FillsTheUnitCube) {
  const Mesh mesh = boxMesh();
  EXPECT_EQ(mesh.triangles.size(), 12U);
  float volume = 0;  // by the divergence theorem: right only when every face looks outwards
  for (const auto& [a, b, c] : mesh.triangles)
    volume += dot(mesh.vertices[a].place, cross(mesh.vertices[b].place, mesh.vertices[c].place)) / 6;
  EXPECT_NEAR(volume, 1, 1e-6F);
}

TEST(Overhang, OfABallAroundTheCubeIsKnown) {
  const float reach = std::sqrt(0.75F);
  const std::vector<spheretree::Node> balls{{{{0, 0, 0}, reach}, spheretree::kNoParent, 0, 0},
                                            {{{0, 0, 0}, 0.5F}, spheretree::kNoParent, 0, 0},
                                            {{{0.5F, 0, 0}, 0.25F}, spheretree::kNoParent, 0, 0}};
  const std::vector<float> overhangs = overhangsOf(balls, boxMesh());
  EXPECT_NEAR(overhangs[0], reach - 0.5F, 0.02F) << "over the middle of a face";
  EXPECT_NEAR(overhangs[1], 0, 1e-5F) << "inside";
  EXPECT_NEAR(overhangs[2], 0.25F, 0.02F) << "half of it is outside";
}

}  // namespace
}  // namespace crowded_room
