// SPDX-License-Identifier: GPL-3.0-or-later
#include "runtime/demo/tree_library.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "tests/unit/demo/room_library.hpp"

namespace crowded_room {
namespace {

namespace fs = std::filesystem;

class TreeFolderTest : public testing::Test {
 protected:
  ~TreeFolderTest() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  /// Two balls of radius 100 side by side, far from the origin.
  const std::string large_ = "2 2\n1000 0 0 200 1\n900 0 0 100 1\n1100 0 0 100 1\n";

  fs::path folder_ = [] {
    const auto* const info = testing::UnitTest::GetInstance()->current_test_info();
    fs::path made = fs::path(testing::TempDir()) / (std::string("room-trees-") + info->name());
    fs::create_directories(made);
    return made;
  }();
};

TEST_F(TreeFolderTest, GivesTreesTheNamesOfTheirFiles) {
  write("rabbit.sph", large_);
  write("box-fine.sph", large_);
  write("notes.txt", "no tree");
  const auto library = TreeLibrary::load(folder_);
  ASSERT_TRUE(library.ok()) << library.error().message;
  ASSERT_EQ(library->trees().size(), 2U);
  EXPECT_EQ(library->trees()[0].name, "box-fine");
  EXPECT_EQ(library->trees()[0].use, TreeUse::Box);
  EXPECT_EQ(library->find("rabbit")->use, TreeUse::Bunny);
  EXPECT_EQ(library->find("rabbit")->file, folder_ / "rabbit.sph");
  EXPECT_EQ(library->usual(TreeUse::Bunny).name, "rabbit");
  EXPECT_EQ(library->usual(TreeUse::Box).name, "box-fine");
  EXPECT_EQ(library->find("hare"), nullptr);
}

TEST_F(TreeFolderTest, MakesAnyTreeAsLargeAsAnObject) {
  write("rabbit.sph", large_);
  const auto library = TreeLibrary::load(folder_);
  ASSERT_TRUE(library.ok());
  const UnitTree& tree = *library->find("rabbit");
  const spheretree::Aabb& bounds = tree.query.bounds();
  EXPECT_NEAR(bounds.max.x, 0.5F, 1e-4F);
  EXPECT_NEAR(bounds.min.x, -0.5F, 1e-4F);
  EXPECT_NEAR(tree.center.x, 1000, 1e-3F);
  // A point of the mesh: the end of the second ball.
  const spheretree::Vec3 point = tree.scale * (spheretree::Vec3{1200, 0, 0} - tree.center);
  EXPECT_NEAR(point.x, 0.5F, 1e-4F);
}

TEST_F(TreeFolderTest, TakesTheSizeFromTheMeshWhereTheFileNamesIt) {
  // The balls of a coarse tree stick out; a finer one of the same mesh must not be a larger object.
  write("coarse.sph", large_ + "# mesh-diagonal: 346.41016\n");
  const auto library = TreeLibrary::load(folder_);
  ASSERT_TRUE(library.ok()) << library.error().message;
  EXPECT_NEAR(library->find("coarse")->scale, 0.005F, 1e-6F);
}

TEST_F(TreeFolderTest, ScaledBallsStillHoldWhatTheyHeld) {
  write("rabbit.sph", large_);
  const auto library = TreeLibrary::load(folder_);
  ASSERT_TRUE(library.ok());
  const UnitTree& tree = *library->find("rabbit");
  for (const spheretree::Node& node : tree.tree.nodes()) {
    const bool root = node.parent == spheretree::kNoParent;
    EXPECT_GT(node.ball.radius, tree.scale * (root ? 200.0F : 100.0F));
  }
}

TEST_F(TreeFolderTest, SaysHowToMakeTreesWhereThereAreNone) {
  write("notes.txt", "no tree");
  for (const fs::path& folder : {folder_, folder_ / "missing"}) {
    const auto library = TreeLibrary::load(folder);
    ASSERT_FALSE(library.ok());
    EXPECT_EQ(library.error().message, howToMakeTrees(folder));
    EXPECT_NE(library.error().message.find("spheretree build bunny.obj -o "), std::string::npos);
    EXPECT_EQ(library.error().message.find('\n'), std::string::npos);
  }
}

TEST_F(TreeFolderTest, NamesTheFileThatIsNoTree) {
  write("good.sph", large_);
  write("bad.sph", "2 2\n1 2 3\n");
  const auto library = TreeLibrary::load(folder_);
  ASSERT_FALSE(library.ok());
  EXPECT_EQ(library.error().message.find((folder_ / "bad.sph").string() + ": "), 0U)
      << library.error().message;
}

TEST_F(TreeFolderTest, RefusesTreesWithoutASize) {
  write("point.sph", "1 2\n1 1 1 0 1\n");
  EXPECT_FALSE(TreeLibrary::load(folder_).ok());
  fs::remove(folder_ / "point.sph");
  write("huge.sph", large_ + "# mesh-diagonal: 0.001\n");
  const auto library = TreeLibrary::load(folder_);
  ASSERT_FALSE(library.ok());
  EXPECT_NE(library.error().message.find("huge.sph"), std::string::npos);
}

TEST_F(TreeFolderTest, LooksInOneFolderAfterTheOther) {
  fs::create_directories(folder_ / "second");
  write("second/rabbit.sph", large_);
  const std::array<fs::path, 3> folders{folder_ / "missing", folder_, folder_ / "second"};
  const auto library = TreeLibrary::loadFirst(folders);
  ASSERT_TRUE(library.ok());
  EXPECT_EQ(library->usual(TreeUse::Bunny).name, "rabbit");
  EXPECT_EQ(library->usual(TreeUse::Box).name, "box-built-in");
  const std::array<fs::path, 2> none{folder_ / "missing", folder_};
  EXPECT_EQ(TreeLibrary::loadFirst(none).error().message, howToMakeTrees(folder_ / "missing"));
}

TEST(BuiltInTest, CoversAUnitCube) {
  const TreeLibrary library = TreeLibrary::builtIn();
  const UnitTree& box = library.usual(TreeUse::Box);
  EXPECT_EQ(&box, &library.usual(TreeUse::Bunny));
  EXPECT_EQ(box.query.levelCount(), 2U);
  for (std::size_t level = 0; level < 2; ++level) {
    for (int corner = 0; corner < 8; ++corner) {
      const spheretree::Vec3 point{(corner & 1) != 0 ? 0.5F : -0.5F, (corner & 2) != 0 ? 0.5F : -0.5F,
                                   (corner & 4) != 0 ? 0.5F : -0.5F};
      bool held = false;
      for (const spheretree::Node& node : box.tree.level(level))
        held = held || length(point - node.ball.center) <= node.ball.radius;
      EXPECT_TRUE(held) << "level " << level << ", corner " << corner;
    }
  }
}

}  // namespace
}  // namespace crowded_room
