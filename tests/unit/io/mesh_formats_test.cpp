// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every format by a round trip: assimp writes a scene with a known solid under a turned and shifted node,
// importMesh reads it. And files by hand for what assimp's writers never write.
#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <assimp/Exporter.hpp>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

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
  // Raw new throughout: the scene's destructor owns it all, as assimp has it.
  scene->mMaterials = new aiMaterial*[1]();
  scene->mMaterials[0] = new aiMaterial();
  scene->mNumMaterials = 1;
  scene->mMeshes = new aiMesh*[1]();
  scene->mMeshes[0] = new aiMesh();
  scene->mNumMeshes = 1;
  aiMesh* out = scene->mMeshes[0];
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

// Two of assimp 5.2's writers are not to be trusted: 3ds applies node transforms twice, fbx leaves the
// sentinels of its binary blocks out. Both formats have tests of their own below.
INSTANTIATE_TEST_SUITE_P(All, MeshFormats,
                         testing::Values(Format{"obj", "obj"}, Format{"ply", "ply"}, Format{"plyb", "ply"},
                                         Format{"stl", "stl"}, Format{"stlb", "stl"},
                                         Format{"collada", "dae"}, Format{"gltf2", "gltf"},
                                         Format{"glb2", "glb"}, Format{"fbxa", "fbx"}),
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

TEST_F(NodeTransforms, A3dsFileIsTurnedYUpByItsRootNode) {
  medial::TriangleMesh placed = box();
  for (Vector3d& vertex : placed.vertices) vertex += Vector3d(10, 20, 30);
  const auto scene = sceneWith(placed, {Eigen::Affine3d::Identity()});
  Assimp::Exporter exporter;
  ASSERT_EQ(exporter.Export(scene.get(), "3ds", in("box.3ds").string()), aiReturn_SUCCESS);
  const Result<ImportedMesh> imported = importMesh(in("box.3ds"));
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  EXPECT_EQ(imported.value().mesh.vertices.size(), 8U);
  EXPECT_TRUE(medial::boundsVolume(imported.value().mesh));
  EXPECT_NEAR(medial::signedVolumeOf(imported.value().mesh), 30, 1e-3);
  // z up becomes y up: (x, y, z) to (x, z, -y).
  EXPECT_LT((medial::boundsOf(imported.value().mesh).min() - Vector3d(9, 27.5, -21.5)).norm(), 1e-4);
  EXPECT_LT((medial::boundsOf(imported.value().mesh).max() - Vector3d(11, 32.5, -18.5)).norm(), 1e-4);
}

/// Writes the binary form of FBX 7.4: nested records of properties.
class BinaryFbx {
 public:
  BinaryFbx() {
    bytes_.assign("Kaydara FBX Binary  ");
    bytes_.append("\0\x1a\0", 3);
    append(std::uint32_t{7400});
  }

  void open(const std::string& name, const std::string& properties, std::uint32_t count) {
    starts_.push_back(bytes_.size());
    append(std::uint32_t{0});  // the end, known when the record is closed
    append(count);
    append(static_cast<std::uint32_t>(properties.size()));
    bytes_ += static_cast<char>(name.size());
    bytes_ += name + properties;
  }
  void close(bool hasChildren) {
    if (hasChildren) bytes_.append(13, '\0');
    const auto end = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data() + starts_.back(), &end, sizeof end);
    starts_.pop_back();
  }
  void leaf(const std::string& name, const std::string& properties, std::uint32_t count) {
    open(name, properties, count);
    close(false);
  }
  [[nodiscard]] std::string bytes() const { return bytes_ + std::string(13, '\0') + std::string(160, '\0'); }

  static std::string number(std::int32_t value) { return "I" + raw(value); }
  static std::string number(std::int64_t value) { return "L" + raw(value); }
  static std::string number(double value) { return "D" + raw(value); }
  static std::string text(const std::string& value) {
    return "S" + raw(static_cast<std::uint32_t>(value.size())) + value;
  }
  template <class Number>
  static std::string array(char type, const std::vector<Number>& values) {
    std::string bytes = type + raw(static_cast<std::uint32_t>(values.size())) + raw(std::uint32_t{0}) +
                        raw(static_cast<std::uint32_t>(values.size() * sizeof(Number)));
    for (const Number value : values) bytes += raw(value);
    return bytes;
  }

 private:
  template <class Number>
  static std::string raw(Number value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
  }
  void append(std::uint32_t value) { bytes_ += raw(value); }

  std::string bytes_;
  std::vector<std::size_t> starts_;
};

TEST_F(NodeTransforms, BinaryFbxKeepsItsOwnUnitsAndAxes) {
  const auto named = [](const std::string& name, const std::string& kind) {
    return BinaryFbx::text(name + std::string("\0\x01", 2) + kind);
  };
  const auto property = [](const std::string& name, const std::string& type,
                           const std::vector<double>& values) {
    std::string text =
        BinaryFbx::text(name) + BinaryFbx::text(type) + BinaryFbx::text("") + BinaryFbx::text("A");
    for (const double value : values) text += BinaryFbx::number(value);
    return text;
  };
  const auto integer = [](const std::string& name, std::int32_t value) {
    return BinaryFbx::text(name) + BinaryFbx::text("int") + BinaryFbx::text("Integer") + BinaryFbx::text("") +
           BinaryFbx::number(value);
  };
  BinaryFbx fbx;
  fbx.open("FBXHeaderExtension", "", 0);
  fbx.leaf("FBXVersion", BinaryFbx::number(std::int32_t{7400}), 1);
  fbx.close(true);
  fbx.open("GlobalSettings", "", 0);
  fbx.open("Properties70", "", 0);
  fbx.leaf("P", integer("UpAxis", 2), 5);
  fbx.leaf("P", integer("FrontAxis", 1), 5);
  fbx.leaf("P", integer("FrontAxisSign", -1), 5);
  fbx.leaf("P", property("UnitScaleFactor", "double", {2.54}), 5);  // inches
  fbx.close(true);
  fbx.close(true);
  fbx.open("Objects", "", 0);
  fbx.open("Geometry",
           BinaryFbx::number(std::int64_t{100}) + named("box", "Geometry") + BinaryFbx::text("Mesh"), 3);
  fbx.leaf("Vertices", BinaryFbx::array<double>('d', {0, 0, 0, 2, 0, 0, 2, 3, 0, 0, 3, 0,
                                                      0, 0, 5, 2, 0, 5, 2, 3, 5, 0, 3, 5}),
           1);
  // Quadrilaterals; the last corner of each is given as its complement.
  fbx.leaf("PolygonVertexIndex", BinaryFbx::array<std::int32_t>('i', {3, 2, 1, ~0, 4, 5, 6, ~7, 0, 1, 5, ~4,
                                                                      1, 2, 6, ~5, 2, 3, 7, ~6, 3, 0, 4, ~7}),
           1);
  fbx.close(true);
  fbx.open("Model", BinaryFbx::number(std::int64_t{200}) + named("box", "Model") + BinaryFbx::text("Mesh"),
           3);
  fbx.open("Properties70", "", 0);
  fbx.leaf("P", property("Lcl Translation", "Lcl Translation", {10, 20, 30}), 7);
  fbx.close(true);
  fbx.close(true);
  fbx.close(true);
  fbx.open("Connections", "", 0);
  fbx.leaf(
      "C",
      BinaryFbx::text("OO") + BinaryFbx::number(std::int64_t{100}) + BinaryFbx::number(std::int64_t{200}), 3);
  fbx.leaf("C",
           BinaryFbx::text("OO") + BinaryFbx::number(std::int64_t{200}) + BinaryFbx::number(std::int64_t{0}),
           3);
  fbx.close(true);

  const Result<ImportedMesh> imported = importMesh(put("box.fbx", fbx.bytes()));
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  EXPECT_EQ(imported.value().report.polygons, 6U);
  EXPECT_EQ(imported.value().report.triangulated, 6U);
  EXPECT_TRUE(medial::boundsVolume(imported.value().mesh));
  EXPECT_NEAR(medial::signedVolumeOf(imported.value().mesh), 30, 1e-4);
  EXPECT_LT((medial::boundsOf(imported.value().mesh).min() - Vector3d(10, 20, 30)).norm(), 1e-5);
  EXPECT_LT((medial::boundsOf(imported.value().mesh).max() - Vector3d(12, 23, 35)).norm(), 1e-5);
}

}  // namespace
}  // namespace spheretree::io
