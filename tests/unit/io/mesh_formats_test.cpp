// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every format by a round trip: assimp writes a scene with a known solid under a turned and shifted node,
// importMesh reads it. And files by hand for what assimp's writers never write.
#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <assimp/Exporter.hpp>
#include <memory>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "io/mesh_check.hpp"
#include "io/mesh_import.hpp"
#include "medial/triangle_mesh.hpp"
#include "models/shapes.hpp"
#include "test_folder.hpp"

namespace spheretree::io {
namespace {

using Eigen::Vector3d;

// 2 x 3 x 5, so that no axis can be mistaken for another.
medial::TriangleMesh box() {
  return models::makeBox({2, 3, 5});
}

/// A quarter turn about z (x becomes y), then a shift.
Eigen::Affine3d placement() {
  return Eigen::Translation3d(10, 20, 30) * Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ());
}

aiMatrix4x4 toAssimp(const Eigen::Affine3d& transform) {
  aiMatrix4x4 matrix;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column)
      matrix[row][column] =
          static_cast<float>(transform.matrix()(static_cast<int>(row), static_cast<int>(column)));
  return matrix;
}

/// One mesh, used by as many nodes under the root as there are transforms.
std::unique_ptr<aiScene> sceneWith(const medial::TriangleMesh& mesh,
                                   const std::vector<Eigen::Affine3d>& transforms) {
  auto scene = std::make_unique<aiScene>();
  scene->mMaterials = new aiMaterial* [1] { new aiMaterial() };
  scene->mNumMaterials = 1;
  auto* out = new aiMesh();
  out->mName = "solid";
  out->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  out->mNumVertices = static_cast<unsigned>(mesh.vertices.size());
  out->mVertices = new aiVector3D[mesh.vertices.size()];
  out->mNormals = new aiVector3D[mesh.vertices.size()];
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3f p = mesh.vertices[v].cast<float>();
    out->mVertices[v] = aiVector3D(p.x(), p.y(), p.z());
    out->mNormals[v] = aiVector3D(0, 0, 1);
  }
  out->mNumFaces = static_cast<unsigned>(mesh.triangles.size());
  out->mFaces = new aiFace[mesh.triangles.size()];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    out->mFaces[t].mNumIndices = 3;
    out->mFaces[t].mIndices =
        new unsigned[3]{mesh.triangles[t][0], mesh.triangles[t][1], mesh.triangles[t][2]};
  }
  scene->mMeshes = new aiMesh* [1] { out };
  scene->mNumMeshes = 1;
  scene->mRootNode = new aiNode("root");
  for (std::size_t i = 0; i < transforms.size(); ++i) {
    auto* node = new aiNode("part" + std::to_string(i));
    node->mTransformation = toAssimp(transforms[i]);
    node->mMeshes = new unsigned[1]{0};
    node->mNumMeshes = 1;
    scene->mRootNode->addChildren(1, &node);
  }
  return scene;
}

struct Format {
  std::string id;  ///< as assimp's exporter knows it
  std::string extension;
};

class MeshFormats : public tests::InFolder, public testing::WithParamInterface<Format> {};

TEST_P(MeshFormats, AClosedSolidUnderANodeComesBackInPlace) {
  const std::filesystem::path path = in("box." + GetParam().extension);
  const auto scene = sceneWith(box(), {placement()});
  Assimp::Exporter exporter;
  ASSERT_EQ(exporter.Export(scene.get(), GetParam().id, path.string()), aiReturn_SUCCESS)
      << exporter.GetErrorString();

  const Result<ImportedMesh> imported = importMesh(path);
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  const medial::TriangleMesh& mesh = imported.value().mesh;
  EXPECT_EQ(mesh.vertices.size(), 8U);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_EQ(imported.value().report.meshes, 1U);
  EXPECT_TRUE(medial::boundsVolume(mesh));
  EXPECT_NEAR(medial::signedVolumeOf(mesh), 30, 1e-3);
  // A quarter turn about z: half extents 1.5, 1, 2.5 around (10, 20, 30).
  EXPECT_LT((medial::boundsOf(mesh).min() - Vector3d(8.5, 19, 27.5)).norm(), 1e-4);
  EXPECT_LT((medial::boundsOf(mesh).max() - Vector3d(11.5, 21, 32.5)).norm(), 1e-4);
}

std::string nameOf(const testing::TestParamInfo<Format>& info) {
  return info.param.id;
}

INSTANTIATE_TEST_SUITE_P(All, MeshFormats,
                         testing::Values(Format{"obj", "obj"}, Format{"ply", "ply"}, Format{"plyb", "ply"},
                                         Format{"stl", "stl"}, Format{"stlb", "stl"},
                                         Format{"collada", "dae"}, Format{"3ds", "3ds"},
                                         Format{"gltf2", "gltf"}, Format{"glb2", "glb"}, Format{"fbx", "fbx"},
                                         Format{"fbxa", "fbx"}),
                         nameOf);

class NodeTransforms : public tests::InFolder {};

TEST_F(NodeTransforms, InstancesAreMergedAndMirroredOnesTurnedBack) {
  Eigen::Affine3d mirrored = Eigen::Affine3d::Identity();
  mirrored.linear() = Vector3d(-1, 1, 1).asDiagonal();
  mirrored.translation() = Vector3d(100, 0, 0);
  const auto scene = sceneWith(box(), {placement(), mirrored});
  Assimp::Exporter exporter;
  ASSERT_EQ(exporter.Export(scene.get(), "glb2", in("two.glb").string()), aiReturn_SUCCESS);
  const Result<ImportedMesh> imported = importMesh(in("two.glb"));
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  EXPECT_EQ(imported.value().report.meshes, 2U);
  EXPECT_EQ(imported.value().mesh.triangles.size(), 24U);
  EXPECT_NEAR(medial::signedVolumeOf(imported.value().mesh), 60, 1e-3);
}

std::string colladaTriangle(const std::string& asset, const std::string& node) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
         asset +
         R"(</asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 0 2 0 0 0 3</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles>
</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node id="n">)" +
         node +
         R"(<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

TEST_F(NodeTransforms, ColladaUpAxisAndUnitAreNodeTransforms) {
  const Result<ImportedMesh> plain =
      importMesh(put("y.dae", colladaTriangle("<unit meter=\"1\"/><up_axis>Y_UP</up_axis>", "")));
  ASSERT_TRUE(plain.ok()) << plain.error().message;
  EXPECT_LT((medial::boundsOf(plain.value().mesh).max() - Vector3d(1, 2, 3)).norm(), 1e-6);
  // Z_UP: z becomes y and y becomes -z. Centimetres become metres.
  const Result<ImportedMesh> turned = importMesh(put(
      "z.dae", colladaTriangle("<unit meter=\"0.01\"/><up_axis>Z_UP</up_axis>",
                               "<translate>1 0 0</translate><rotate>0 0 1 90</rotate><scale>2 2 2</scale>")));
  ASSERT_TRUE(turned.ok()) << turned.error().message;
  // Local (1,2,3) box scaled to (2,4,6), turned about z to x in [-4,0], y in [0,2], shifted to x in [-3,1].
  const Eigen::AlignedBox3d bounds = medial::boundsOf(turned.value().mesh);
  EXPECT_LT((bounds.min() - Vector3d(-0.03, 0, -0.02)).norm(), 1e-6) << bounds.min().transpose();
  EXPECT_LT((bounds.max() - Vector3d(0.01, 0.06, 0)).norm(), 1e-6) << bounds.max().transpose();
  EXPECT_GT(medial::signedVolumeOf(turned.value().mesh), 0);
}

}  // namespace
}  // namespace spheretree::io
