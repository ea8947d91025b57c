// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/asset_scan.hpp"

#include <string>

#include <gtest/gtest.h>

#include "io/files.hpp"
#include "io/mesh_import.hpp"
#include "io/mesh_write.hpp"
#include "models/shapes.hpp"
#include "test_folder.hpp"

namespace spheretree::io {
namespace {

class Scan : public tests::InFolder {
 protected:
  [[nodiscard]] AssetScan scan(const std::string& name) const { return *scanAsset(in(name)); }
};

TEST_F(Scan, TheHashIsThatOfTheImport) {
  put("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(scan("a.obj").contentHash, importMesh(in("a.obj"))->report.contentHash);
  put("b.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
  EXPECT_NE(scan("a.obj").contentHash, scan("b.obj").contentHash);
}

TEST_F(Scan, TrianglesAreGuessedWithinAFactorOfThree) {
  const models::Model& knot = *std::find_if(models::allModels().begin(), models::allModels().end(),
                                            [](const models::Model& model) { return model.name == "knot"; });
  const auto mesh = knot.make();
  const auto triangles = static_cast<double>(mesh.triangles.size());
  for (const char* name : {"a.obj", "a.off", "a.ply", "a.stl"}) {
    ASSERT_TRUE(writeMesh(in(name), mesh, Overwrite::Refuse).ok()) << name;
    const auto guess = static_cast<double>(scan(name).triangleGuess);
    EXPECT_GT(guess, triangles / 3) << name;
    EXPECT_LT(guess, triangles * 3) << name;
  }
}

TEST_F(Scan, ALieInAHeaderReservesNothing) {
  put("a.ply", "ply\nformat ascii 1.0\nelement face 4000000000\nend_header\n");
  EXPECT_LT(scan("a.ply").triangleGuess, 1000U);
}

TEST_F(Scan, TheBuffersOfAGltfCount) {
  put("a.gltf", R"({"buffers": [{"uri": "a.bin"}, {"uri": "data:;base64,AAAA"}]})");
  put("a.bin", "one");
  const std::string before = scan("a.gltf").contentHash;
  put("a.bin", "two");
  EXPECT_NE(scan("a.gltf").contentHash, before);
}

TEST_F(Scan, MissingFilesAndFoldersAreNamed) {
  EXPECT_EQ(scanAsset(in("nothing")).error().message, in("nothing").string() + ": No such file or directory");
  EXPECT_EQ(scanAsset(folder_).error().message, folder_.string() + ": is a directory");
}

}  // namespace
}  // namespace spheretree::io
