// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "builders/level_driver.hpp"
#include "models/shapes.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;

BallTree octreeOf(const medial::TriangleMesh& mesh, std::uint32_t levels, Cover cover,
                  std::uint32_t branch = 8) {
  const medial::Surface surface = std::move(medial::Surface::create(mesh)).value();
  BuildSettings settings;
  settings.levels = levels;
  settings.branch = branch;
  settings.cover = cover;
  return buildOctree(surface, settings, medial::Context(1));
}

TEST(Octree, OfACubeIsKnownByHand) {
  const BallTree shell = octreeOf(models::makeBox({1, 1, 1}), 4, Cover::Surface);
  ASSERT_EQ(shell.levels.size(), 4U);
  EXPECT_EQ(shell.levels[0].size(), 1U);
  EXPECT_EQ(shell.levels[1].size(), 8U);
  EXPECT_EQ(shell.levels[2].size(), 4U * 4 * 4 - 2 * 2 * 2);
  EXPECT_EQ(shell.levels[3].size(), 8U * 8 * 8 - 6 * 6 * 6);
  EXPECT_NEAR(shell.levels[0][0].ball.radius, std::sqrt(3.0) / 2, 1e-12);
  double half = 0.25;
  for (std::size_t depth = 1; depth < 4; ++depth, half /= 2) {
    for (const BallTree::Node& node : shell.levels[depth]) {
      ASSERT_NEAR(node.ball.radius, std::sqrt(3.0) * half, 1e-12);
      ASSERT_NEAR(node.ball.center.cwiseAbs().maxCoeff(), 0.5 - half, 1e-12) << "centred in an outer cell";
    }
  }
}

TEST(Octree, OfASolidCubeKeepsTheCellsInside) {
  const BallTree solid = octreeOf(models::makeBox({1, 1, 1}), 4, Cover::Solid);
  EXPECT_EQ(solid.levels[1].size(), 8U);
  EXPECT_EQ(solid.levels[2].size(), 64U);
  // The ball of an inner cell of side 1/4 reaches sqrt(3)/8 from a centre 3/8 deep: it is inside and final.
  EXPECT_EQ(solid.levels[3].size(), 8U * 56 + 8);
}

TEST(Octree, ChildrenStandInTheOrderOfTheirParents) {
  const BallTree tree = octreeOf(models::makeTorus(1, 0.25, 36, 16), 4, Cover::Surface);
  for (std::size_t depth = 1; depth < tree.levels.size(); ++depth) {
    for (std::size_t i = 1; i < tree.levels[depth].size(); ++i) {
      ASSERT_LE(tree.levels[depth][i - 1].parent, tree.levels[depth][i].parent);
    }
    ASSERT_LT(tree.levels[depth].back().parent, tree.levels[depth - 1].size());
  }
}

TEST(Octree, SplitsByAnyBranchingFactor) {
  // A cube split in two, three, four (2 x 2), 27 (3 x 3 x 3): all parts touch the surface on the first level
  // but the one in the middle of 27.
  const medial::TriangleMesh cube = models::makeBox({1, 1, 1});
  EXPECT_EQ(octreeOf(cube, 2, Cover::Surface, 2).levels[1].size(), 2U);
  EXPECT_EQ(octreeOf(cube, 2, Cover::Surface, 3).levels[1].size(), 3U);
  EXPECT_EQ(octreeOf(cube, 2, Cover::Surface, 4).levels[1].size(), 4U);
  EXPECT_EQ(octreeOf(cube, 2, Cover::Surface, 5).levels[1].size(), 4U);
  EXPECT_EQ(octreeOf(cube, 2, Cover::Surface, 27).levels[1].size(), 26U);
  EXPECT_EQ(octreeOf(cube, 2, Cover::Solid, 27).levels[1].size(), 27U);
  const BallTree inTwo = octreeOf(cube, 2, Cover::Surface, 2);
  const std::vector<BallTree::Node>& halves = inTwo.levels[1];
  EXPECT_NEAR(halves[0].ball.radius, std::sqrt(0.25 * 0.25 + 0.5 * 0.5 + 0.5 * 0.5), 1e-12);
}

TEST(Octree, AFaceOnACuttingPlaneBelongsToOneSideOnly) {
  // The faces of a 2 x 2 x 1 block lie at z = +-0.5 in its 2 x 2 x 2 cube, on cutting planes of the second
  // split. Each belongs to the layer of 16 cells below it; of the layer between, the 12 outer cells remain.
  const BallTree tree = octreeOf(models::makeBox({2, 2, 1}), 3, Cover::Surface);
  EXPECT_EQ(tree.levels[1].size(), 8U);
  EXPECT_EQ(tree.levels[2].size(), 16U + 12 + 16);
}

}  // namespace
}  // namespace spheretree::builders
