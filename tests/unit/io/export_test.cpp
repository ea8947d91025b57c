// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <assimp/Importer.hpp>
#include <nlohmann/json.hpp>

#include "io/export.hpp"
#include "io/export_formats.hpp"
#include "io/tree_files.hpp"
#include "io/tree_levels.hpp"

namespace spheretree::io {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

/// Three levels; the second ball of level 1 has no children. Numbers that no short decimal holds.
SphFile smallTree() {
  const std::vector<SphereTree::Entry> entries = {{{{0.1F, 0, 0}, 2.1F}, kNoParent},
                                                  {{{-1.3F, 0.2F, 0}, 1.1F}, 0},
                                                  {{{1.7F, 0, -0.3F}, 0.9F}, 0},
                                                  {{{-1.7F, 0.1F, 0.4F}, 0.7F}, 1},
                                                  {{{-0.9F, 0.3F, 0}, 0.6F}, 1}};
  SphFile file{SphereTree::create(entries).value(), 2, {}, {}};
  file.metadata = {{"mesh-diagonal", "4"},
                   {"level-0", "spheres=1 overhang-worst=[0.2,0.25] overhang-mean=0.125 volume-ratio=2"}};
  return file;
}

std::string exported(ExportFormat format, std::optional<std::size_t> level = {}) {
  const SphFile file = smallTree();
  return exportTree(format, {file, "small <tree>", level}).value();
}

TEST(Export, JsonHoldsEveryBitAndTheHierarchy) {
  const SphereTree tree = smallTree().tree;
  const Json json = Json::parse(exported(ExportFormat::Json));
  EXPECT_EQ(json["content_hash"], treeHash(tree));
  std::vector<SphereTree::Entry> entries;
  std::size_t above = 0;
  for (const Json& level : json["levels"]) {
    const std::size_t first = entries.size();
    for (const Json& sphere : level["spheres"]) {
      const Json& c = sphere["center"];
      const std::uint32_t parent =
          sphere["parent"].is_null()
              ? kNoParent
              : static_cast<std::uint32_t>(above + sphere["parent"].get<std::size_t>());
      entries.push_back(
          {{{c[0].get<float>(), c[1].get<float>(), c[2].get<float>()}, sphere["radius"]}, parent});
    }
    above = first;
  }
  EXPECT_EQ(treeHash(SphereTree::create(entries).value()), treeHash(tree));
}

TEST(Export, ALevelHoldsTheChildlessBallsAboveIt) {
  const SphFile file = smallTree();
  EXPECT_EQ(nodesAtLevel(file.tree, 2).nodes, (std::vector<std::size_t>{2, 3, 4}));
  EXPECT_EQ(nodesAtLevel(file.tree, 2).fromAbove, 1U);
  const Json foam = Json::parse(exported(ExportFormat::Foam));
  ASSERT_EQ(foam.size(), 3U);
  EXPECT_EQ(foam[1]["spheres"].size(), 2U);
  EXPECT_EQ(foam[2]["spheres"].size(), 3U);
}

TEST(Export, FoamHasErrorsInMeshUnits) {
  const Json foam = Json::parse(exported(ExportFormat::Foam));
  EXPECT_DOUBLE_EQ(foam[0]["worst"].get<double>(), 0.25 * 4);
  EXPECT_DOUBLE_EQ(foam[0]["mean"].get<double>(), 0.125 * 4);
  EXPECT_TRUE(foam[1]["worst"].is_null());  // the file does not say
  EXPECT_EQ(foam[0]["spheres"][0]["origin"][0].get<float>(), 0.1F);
  EXPECT_EQ(foam[0]["spheres"][0]["radius"].get<float>(), 2.1F);
}

TEST(Export, NumbersOfRobotFormatsAreNotRounded) {
  // 0.7F is a little less than 0.7, 0.6F a little more: a decimal that reads as another double would lose
  // cover.
  for (const ExportFormat format : {ExportFormat::Urdf, ExportFormat::Srdf, ExportFormat::Curobo}) {
    const std::string text = exported(format);
    EXPECT_THAT(text, HasSubstr("0.699999988079071"));
    EXPECT_THAT(text, HasSubstr("0.6000000238418579"));
  }
}

TEST(Export, NamesAreQuoted) {
  EXPECT_THAT(exported(ExportFormat::Urdf), HasSubstr("link name=\"small &lt;tree&gt;\""));
  EXPECT_THAT(exported(ExportFormat::Srdf), HasSubstr("link=\"small &lt;tree&gt;\""));
  EXPECT_THAT(exported(ExportFormat::Curobo), HasSubstr("  \"small <tree>\":\n"));
}

TEST(Export, ALevelThatIsNotThereIsRefused) {
  const SphFile file = smallTree();
  const Result<std::string> result = exportTree(ExportFormat::Glb, {file, "t", 3});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::InvalidArgument);
  EXPECT_THAT(result.error().message, HasSubstr("0 to 2"));
}

TEST(Export, EndingsChooseTheFormat) {
  EXPECT_EQ(exportFormatOf("a/b.GLB"), ExportFormat::Glb);
  EXPECT_EQ(exportFormatOf("b.yaml"), ExportFormat::Curobo);
  EXPECT_EQ(exportFormatOf("b.sph"), std::nullopt);
}

/// The vertices that a node shows, in the scene's frame.
std::vector<aiVector3D> shownBy(const aiScene& scene, const aiNode& node) {
  aiMatrix4x4 place;
  for (const aiNode* n = &node; n != nullptr; n = n->mParent) place = n->mTransformation * place;
  std::vector<aiVector3D> points;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) points.push_back(place * mesh.mVertices[v]);
  }
  return points;
}

TEST(Export, AnotherReaderSeesTheBallsInTheGlb) {
  const SphFile file = smallTree();
  const std::string bytes = exported(ExportFormat::Glb);
  Assimp::Importer importer;
  const aiScene* scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_ValidateDataStructure, "glb");
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  EXPECT_EQ(scene->mNumMaterials >= 3, true);
  for (std::size_t level = 0; level < 3; ++level) {
    SCOPED_TRACE(level);
    const aiNode* node = scene->mRootNode->FindNode(("level " + std::to_string(level)).c_str());
    ASSERT_NE(node, nullptr);
    const LevelNodes balls = nodesAtLevel(file.tree, level);
    ASSERT_EQ(node->mNumChildren, balls.nodes.size());
    for (unsigned k = 0; k < node->mNumChildren; ++k) {
      const Sphere& ball = file.tree.nodes()[balls.nodes[k]].ball;
      const std::vector<aiVector3D> points = shownBy(*scene, *node->mChildren[k]);
      EXPECT_EQ(points.size(), 162U);  // an icosahedron split twice
      for (const aiVector3D& p : points) {
        const float away = (p - aiVector3D(ball.center.x, ball.center.y, ball.center.z)).Length();
        EXPECT_NEAR(away, ball.radius, 1e-5F);
      }
    }
  }
}

TEST(Export, TheSameTreeGivesTheSameBytes) {
  for (const ExportEntry& entry : exportFormats())
    EXPECT_EQ(exported(entry.format), exported(entry.format)) << entry.name;
}

}  // namespace
}  // namespace spheretree::io
