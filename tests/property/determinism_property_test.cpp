// SPDX-License-Identifier: GPL-3.0-or-later
//
// The number of threads changes nothing.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/trees.hpp"

namespace spheretree::builders {
namespace {

TEST(Determinism, ThreadsDoNotChangeABit) {
  for (const test::Solid& solid : test::allSolids()) {
    if (solid.name != "gear" && solid.name != "torus" && solid.name != "tangent_balls") continue;
    for (const CatalogueEntry& builder : catalogue()) {
      SCOPED_TRACE(solid.name + " " + std::string(builder.name));
      BuildSettings settings = test::quickSettings(builder.name);
      settings.quality = builders::Quality::Fast;
      settings.hubbard.samples = 800;
      settings.grid.orientations = 3;
      const Result<BuildResult> one = buildTree(solid.surface, settings, medial::Context(1));
      ASSERT_TRUE(one.ok()) << one.error().message;
      for (const unsigned threads : {2U, 7U}) {
        const Result<BuildResult> many = buildTree(solid.surface, settings, medial::Context(threads));
        ASSERT_TRUE(many.ok());
        EXPECT_TRUE(test::sameBits(one->tree, many->tree)) << threads << " threads";
        for (std::size_t depth = 0; depth < one->report.levels.size(); ++depth) {
          const LevelMetrics& a = one->report.levels[depth].metrics;
          const LevelMetrics& b = many->report.levels[depth].metrics;
          EXPECT_EQ(a.overhangWorst.upper, b.overhangWorst.upper);
          EXPECT_EQ(a.overhangMean, b.overhangMean);
          EXPECT_EQ(a.volume, b.volume);
          EXPECT_EQ(a.surface.effort.cells, b.surface.effort.cells);
          EXPECT_EQ(a.solid.uncovered.upper, b.solid.uncovered.upper);
        }
      }
    }
  }
}

}  // namespace
}  // namespace spheretree::builders
