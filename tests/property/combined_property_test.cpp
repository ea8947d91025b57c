// SPDX-License-Identifier: GPL-3.0-or-later
//
// What linking and refining may not break: the limit of children below every ball, the bytes, and the order
// between combined and the reducers it was given.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/trees.hpp"

namespace spheretree::builders {
namespace {

/// Edged and round, thin, with a hole, in two parts.
std::vector<test::Solid> someSolids() {
  std::vector<test::Solid> some;
  for (test::Solid& solid : test::allSolids()) {
    for (const char* name : {"l_block", "gear", "torus", "spike", "two_boxes"}) {
      if (solid.name == name) some.push_back(std::move(solid));
    }
  }
  return some;
}

BuildSettings linked(std::uint32_t branch, std::uint32_t levels) {
  BuildSettings settings = test::quickSettings("combined", levels);
  settings.branch = branch;
  settings.combined.reducers = {"merge", "expand"};
  settings.refine = Toggle::On;
  settings.link = Toggle::On;
  return settings;
}

class Branch : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Combined, Branch, testing::Values(2U, 3U, 8U));

TEST_P(Branch, LinkedLevelsKeepTheLimitOfEveryParent) {
  const std::uint32_t branch = GetParam();
  for (const test::Solid& solid : someSolids()) {
    for (const Cover cover : {Cover::Surface, Cover::Solid}) {
      if (cover == Cover::Solid && solid.name != "l_block" && solid.name != "two_boxes") continue;
      SCOPED_TRACE(solid.name + (cover == Cover::Solid ? ", solid" : ", surface"));
      BuildSettings settings = linked(branch, branch == 2 ? 5 : 3);
      settings.cover = cover;
      const Result<BuildResult> built = buildTree(solid.surface, settings, medial::Context(2));
      ASSERT_TRUE(built.ok()) << built.error().message;
      EXPECT_LE(built->tree.maxChildren(), branch);
      std::size_t slots = 1;
      for (std::size_t depth = 0; depth < built->tree.levelCount(); ++depth, slots *= branch) {
        const LevelMetrics& m = built->report.levels[depth].metrics;
        EXPECT_LE(m.spheres, slots) << "level " << depth;
        EXPECT_TRUE(m.surface.certified) << "level " << depth;
        EXPECT_TRUE(cover == Cover::Surface || m.solid.certified) << "level " << depth;
      }
    }
  }
}

TEST(CombinedProperty, ThreadsDoNotChangeABit) {
  for (const test::Solid& solid : someSolids()) {
    if (solid.name != "gear" && solid.name != "two_boxes") continue;
    SCOPED_TRACE(solid.name);
    const BuildSettings settings = linked(8, 3);
    const Result<BuildResult> one = buildTree(solid.surface, settings, medial::Context(1));
    ASSERT_TRUE(one.ok()) << one.error().message;
    for (const unsigned threads : {2U, 3U, 8U}) {
      const Result<BuildResult> many = buildTree(solid.surface, settings, medial::Context(threads));
      ASSERT_TRUE(many.ok()) << many.error().message;
      EXPECT_TRUE(test::sameBits(one->tree, many->tree)) << threads << " threads";
    }
  }
}

struct Driver {
  std::string name;
  Toggle refine;
  Quality quality;
  double tolerance;
};

// Sets are compared by their stand-off. Where the nearest surface is shadowed the overhang is a little less
// than that, and not for all sets by the same.
constexpr double kShadow = 1.01;
// How far `fast` may miss what one of many reducers finds by luck.
constexpr double kFast = 1.06;

/// Refined and linked, or naked as in the paper.
class Rivals : public testing::TestWithParam<Driver> {};
INSTANTIATE_TEST_SUITE_P(Combined, Rivals,
                         testing::Values(Driver{"Naked", Toggle::Off, Quality::Normal, kShadow},
                                         Driver{"Fast", Toggle::On, Quality::Fast, kFast},
                                         Driver{"Refined", Toggle::On, Quality::Normal, kShadow}),
                         [](const auto& row) { return row.param.name; });

TEST_P(Rivals, NoReducerGivenIsBetterOnAnyLevel) {
  for (const test::Solid& solid : someSolids()) {
    BuildSettings settings = test::quickSettings("combined");
    settings.combined.reducers = {"grid", "spawn", "merge", "burst", "expand"};
    settings.refine = GetParam().refine;
    settings.link = GetParam().refine;
    settings.quality = GetParam().quality;
    const Result<BuildResult> combined = buildTree(solid.surface, settings, medial::Context(2));
    ASSERT_TRUE(combined.ok()) << combined.error().message;
    for (const std::string& reducer : settings.combined.reducers) {
      SCOPED_TRACE(solid.name + ", " + reducer);
      const Result<BuildResult> single =
          buildTree(solid.surface, test::quickSettings(reducer), medial::Context(2));
      ASSERT_TRUE(single.ok()) << single.error().message;
      // Naked, the paper's greedy choice: the best set of a node may leave regions that are worse to cover
      // than another set's, so it promises the first level alone.
      const std::size_t depths = GetParam().refine == Toggle::On ? single->report.levels.size() : 2;
      for (std::size_t depth = 0; depth < std::min(depths, single->report.levels.size()); ++depth) {
        // A tree that ended early had nothing to gain: its last level stands for the ones below.
        const std::size_t same = std::min(depth, combined->report.levels.size() - 1);
        EXPECT_LE(combined->report.levels[same].metrics.overhangWorst.lower,
                  GetParam().tolerance * single->report.levels[depth].metrics.overhangWorst.upper)
            << "level " << depth;
      }
    }
  }
}

}  // namespace
}  // namespace spheretree::builders
