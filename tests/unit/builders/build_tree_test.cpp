// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/build_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "builders/catalogue.hpp"
#include "models/shapes.hpp"
#include "tests/support/trees.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;

medial::Surface surfaceOf(medial::TriangleMesh mesh) {
  return std::move(medial::Surface::create(std::move(mesh))).value();
}

class EveryBuilder : public testing::TestWithParam<CatalogueEntry> {};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryBuilder, testing::ValuesIn(catalogue().begin(), catalogue().end()),
                         [](const auto& row) { return std::string(row.param.name); });

TEST_P(EveryBuilder, KeepsItsPromises) {
  const medial::Surface torus = surfaceOf(models::makeTorus(1, 0.25, 24, 12));
  const Result<BuildResult> built =
      buildTree(torus, test::quickSettings(GetParam().name, 3), medial::Context(2));
  ASSERT_TRUE(built.ok()) << built.error().message;
  const BuildReport& report = built->report;
  ASSERT_EQ(report.levels.size(), built->tree.levelCount());
  EXPECT_TRUE(report.surfaceChains.certified);
  std::size_t slots = 1;
  for (std::size_t depth = 0; depth < report.levels.size(); ++depth, slots *= 8) {
    const LevelMetrics& m = report.levels[depth].metrics;
    EXPECT_TRUE(m.surface.certified) << "level " << depth;
    EXPECT_EQ(m.spheres, built->tree.level(depth).size());
    EXPECT_LE(m.spheres, slots);
    EXPECT_GE(m.volumeRatio, m.solid.certified ? 1.0 : 0.0);
    EXPECT_LE(m.overhangWorst.lower, m.overhangWorst.upper);
  }
  EXPECT_LT(report.levels[2].metrics.overhangWorst.upper, report.levels[1].metrics.overhangWorst.lower);
}

TEST_P(EveryBuilder, TakesAnyBranchAndAnyDepth) {
  const medial::Surface block = surfaceOf(models::makeLBlock());
  for (const std::uint32_t branch : {2U, 3U, 27U}) {
    BuildSettings settings = test::quickSettings(GetParam().name, branch == 2 ? 5 : (branch == 3 ? 3 : 2));
    settings.branch = branch;
    const Result<BuildResult> built = buildTree(block, settings, medial::Context(2));
    ASSERT_TRUE(built.ok()) << built.error().message;
    EXPECT_LE(built->tree.maxChildren(), branch);
    EXPECT_EQ(built->tree.levelCount(), settings.levels);
  }
  const Result<BuildResult> single =
      buildTree(block, test::quickSettings(GetParam().name, 1), medial::Context(1));
  ASSERT_TRUE(single.ok());
  EXPECT_EQ(single->tree.nodes().size(), 1U);
}

TEST_P(EveryBuilder, CoversTheSolidWhenAsked) {
  for (const medial::TriangleMesh& mesh : {models::makeBox({1, 2, 3}), models::makeUBlock()}) {
    BuildSettings settings = test::quickSettings(GetParam().name, 3);
    settings.cover = Cover::Solid;
    const medial::Surface surface = surfaceOf(mesh);
    const Result<BuildResult> built = buildTree(surface, settings, medial::Context(2));
    ASSERT_TRUE(built.ok()) << built.error().message;
    EXPECT_TRUE(built->report.solidChains.certified);
    for (const LevelReport& level : built->report.levels) {
      EXPECT_TRUE(level.metrics.solid.certified);
      EXPECT_GE(level.metrics.volumeRatio, 1);
    }
  }
}

TEST_P(EveryBuilder, StopsWhereTheErrorIsSmallEnough) {
  const medial::Surface ball = surfaceOf(models::makeBall(1, 3));
  BuildSettings settings = test::quickSettings(GetParam().name, 6);
  // The ball around an icosphere overhangs by less than a hundredth of its diagonal: one ball is enough.
  settings.maxError = 0.01;
  const Result<BuildResult> enough = buildTree(ball, settings, medial::Context(2));
  ASSERT_TRUE(enough.ok());
  EXPECT_EQ(enough->tree.levelCount(), 1U);
  EXPECT_TRUE(enough->report.errorBoundMet);

  const medial::Surface block = surfaceOf(models::makeLBlock());
  settings.levels = GetParam().name == "octree" ? 5 : 4;  // the octree comes down slowly
  settings.maxError = GetParam().name == "octree" ? 0.15 : 0.1;
  const Result<BuildResult> block4 = buildTree(block, settings, medial::Context(2));
  ASSERT_TRUE(block4.ok());
  EXPECT_TRUE(block4->report.errorBoundMet);
  EXPECT_LE(block4->report.levels.back().metrics.overhangWorst.upper, settings.maxError * block.diagonal());
  const BuildSettings full = test::quickSettings(GetParam().name, settings.levels);
  const Result<BuildResult> unlimited = buildTree(block, full, medial::Context(2));
  ASSERT_TRUE(unlimited.ok());
  EXPECT_LT(block4->tree.nodes().size(), unlimited->tree.nodes().size());

  settings.levels = 2;
  settings.maxError = 1e-6;
  const Result<BuildResult> missed = buildTree(block, settings, medial::Context(2));
  ASSERT_TRUE(missed.ok());
  EXPECT_FALSE(missed->report.errorBoundMet);
}

TEST_P(EveryBuilder, StopsWhenCancelled) {
  const medial::Surface torus = surfaceOf(models::makeTorus(1, 0.25, 36, 16));
  medial::Context context(2);
  context.cancel();
  const Result<BuildResult> built = buildTree(torus, test::quickSettings(GetParam().name, 4), context);
  ASSERT_FALSE(built.ok());
  EXPECT_EQ(built.error().code, ErrorCode::Cancelled);
}

TEST(BuildTree, ABallMeshNeedsOneBall) {
  const medial::Surface ball = surfaceOf(models::makeBall(1, 4));
  const Result<BuildResult> built = buildTree(ball, test::quickSettings("hubbard", 3), medial::Context(2));
  ASSERT_TRUE(built.ok());
  const LevelMetrics& root = built->report.levels[0].metrics;
  EXPECT_LT(root.overhangWorst.upper, 0.002 * ball.diagonal());
  EXPECT_NEAR(root.volumeRatio, 1, 0.02);
}

TEST(BuildTree, TheRootOfABoxOverhangsAtItsLargestFace) {
  const medial::Surface box = surfaceOf(models::makeBox({3, 2, 1}));
  const Result<BuildResult> built = buildTree(box, test::quickSettings("octree", 1), medial::Context(1));
  ASSERT_TRUE(built.ok());
  const double expected = std::sqrt(14.0) / 2 - 0.5;
  EXPECT_NEAR(built->report.levels[0].metrics.overhangWorst.upper, expected, 1e-4);
}

TEST(BuildTree, RefusesWhatFloatsCannotHold) {
  const auto built = [](double size, double offset) {
    medial::TriangleMesh mesh = models::makeLBlock();
    for (Vector3d& v : mesh.vertices) v = size * v + Vector3d(0, offset, 0);
    return buildTree(surfaceOf(mesh), test::quickSettings("octree", 2), medial::Context(1));
  };
  for (const auto& [size, offset] : {std::pair{1e39, 0.0}, {3e38, 1e38}, {1.0, 1e9}, {1e-45, 0.0}}) {
    const Result<BuildResult> result = built(size, offset);
    ASSERT_FALSE(result.ok()) << size << " at " << offset;
    EXPECT_EQ(result.error().code, ErrorCode::UnsuitableMesh);
    EXPECT_NE(result.error().message.find("single precision"), std::string::npos) << result.error().message;
  }
  for (const auto& [size, offset] : {std::pair{1e37, 0.0}, {1.0, 1e6}, {1e-42, 0.0}}) {
    const Result<BuildResult> result = built(size, offset);
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_TRUE(result->report.surfaceChains.certified);
  }
}

TEST(BuildTree, SaysHowFinelyFloatsPlaceTheBalls) {
  medial::TriangleMesh mesh = models::makeBox({2, 3, 6});  // diagonal 7
  for (Vector3d& v : mesh.vertices) v.x() += (1 << 20);
  const Result<BuildResult> result =
      buildTree(surfaceOf(mesh), test::quickSettings("octree", 2), medial::Context(1));
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_DOUBLE_EQ(result->report.coordinateStep, 0.125 / 7);  // 24 bits from 2^20 down
}

TEST(BuildTree, RefusesImpossibleSettings) {
  const medial::Surface box = surfaceOf(models::makeBox({1, 1, 1}));
  const auto reason = [&](auto change) {
    BuildSettings settings;
    change(settings);
    const Result<BuildResult> built = buildTree(box, settings, medial::Context(1));
    EXPECT_FALSE(built.ok());
    if (built.ok()) return std::string();
    EXPECT_EQ(built.error().code, ErrorCode::InvalidArgument);
    return built.error().message;
  };
  EXPECT_NE(reason([](auto& s) { s.builder = "octre"; }).find("octre"), std::string::npos);
  EXPECT_NE(reason([](auto& s) { s.branch = 1; }).find("branch"), std::string::npos);
  EXPECT_NE(reason([](auto& s) { s.levels = 0; }).find("levels"), std::string::npos);
  EXPECT_NE(reason([](auto& s) { s.maxError = -1; }).find("max-error"), std::string::npos);
  EXPECT_NE(reason([](auto& s) { s.axis.error = 0; }).find("axis-error"), std::string::npos);
  EXPECT_NE(reason([](auto& s) { s.combined.reducers = {"octree"}; }).find("octree"), std::string::npos);
  EXPECT_NE(reason([](auto& s) { s.refine = Toggle::Off, s.link = Toggle::On; }).find("link needs refine"),
            std::string::npos);
}

}  // namespace
}  // namespace spheretree::builders
