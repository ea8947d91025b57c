// SPDX-License-Identifier: GPL-3.0-or-later
//
// The combined builder: reducers that compete for every set of balls.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builders/build_tree.hpp"
#include "builders/catalogue.hpp"
#include "builders/set_error.hpp"
#include "models/shapes.hpp"
#include "tests/support/trees.hpp"
#include "tests/unit/builders/solids.hpp"

namespace spheretree::builders {
namespace {

BuildSettings naked(std::vector<std::string> reducers) {
  BuildSettings settings = test::quickSettings("combined");
  settings.combined.reducers = std::move(reducers);
  settings.refine = Toggle::Off;
  settings.link = Toggle::Off;
  return settings;
}

BuildResult build(const medial::Surface& surface, const BuildSettings& settings) {
  Result<BuildResult> built = buildTree(surface, settings, medial::Context(2));
  EXPECT_TRUE(built.ok()) << (built.ok() ? "" : built.error().message);
  return std::move(built).value();
}

/// Nodes with more than one child: sets of balls that were made, not repeated.
std::size_t setsBelow(const SphereTree& tree, std::size_t level) {
  std::size_t sets = 0;
  for (const Node& node : tree.level(level)) sets += node.childCount > 1 ? 1 : 0;
  return sets;
}

TEST(Combined, OneReducerIsThatReducerAlone) {
  const medial::Surface surface = surfaceOf(models::makeLBlock());
  for (const CatalogueEntry& entry : catalogue()) {
    if (entry.makeReducer == nullptr) continue;
    SCOPED_TRACE(entry.name);
    const BuildResult alone = build(surface, test::quickSettings(entry.name));
    const BuildResult combined = build(surface, naked({std::string(entry.name)}));
    EXPECT_TRUE(test::sameBits(alone.tree, combined.tree));
    for (std::size_t level = 1; level < combined.report.levels.size(); ++level)
      EXPECT_EQ(alone.report.levels.at(level).winners, combined.report.levels[level].winners);
  }
}

TEST(Combined, FiveLevelsOfATorusAreCoveredAndEachSticksOutLess) {
  const medial::Surface surface = surfaceOf(models::makeTorus(2, 0.7, 24, 12));
  BuildSettings settings;
  settings.builder = "combined";
  settings.quality = Quality::Fast;
  settings.levels = 5;
  const BuildResult built = build(surface, settings);
  ASSERT_EQ(built.tree.levelCount(), 5U);
  std::size_t most = 1;
  for (std::size_t level = 0; level < 5; ++level, most *= settings.branch) {
    EXPECT_LE(built.tree.level(level).size(), most) << "level " << level;
    if (level == 0) continue;
    EXPECT_LT(built.report.levels[level].metrics.overhangWorst.upper,
              built.report.levels[level - 1].metrics.overhangWorst.upper)
        << "level " << level;
  }
  EXPECT_TRUE(built.report.surfaceChains.certified);
}

TEST(Combined, TheOrderOfTheNamesDoesNotMatter) {
  const medial::Surface surface = surfaceOf(models::makeGear(7));
  const BuildResult forwards = build(surface, naked({"grid", "merge", "expand"}));
  const BuildResult backwards = build(surface, naked({"expand", "merge", "grid"}));
  EXPECT_TRUE(test::sameBits(forwards.tree, backwards.tree));
}

TEST(Combined, EverySetHasOneWinnerAmongTheReducersNamed) {
  const medial::Surface surface = surfaceOf(models::makeGear(7));
  for (const bool refined : {false, true}) {
    BuildSettings settings = naked({"spawn", "merge", "expand"});
    if (refined) settings.refine = Toggle::On;
    const BuildResult built = build(surface, settings);
    ASSERT_EQ(built.tree.levelCount(), 3U);
    EXPECT_TRUE(built.report.levels[0].winners.empty()) << "the root is nobody's";
    for (std::size_t level = 1; level < built.tree.levelCount(); ++level) {
      std::size_t sets = 0;
      for (const auto& [name, won] : built.report.levels[level].winners) {
        EXPECT_TRUE(name == "spawn" || name == "merge" || name == "expand") << name;
        EXPECT_GT(won, 0U) << name;
        sets += won;
      }
      EXPECT_EQ(sets, setsBelow(built.tree, level - 1));
    }
  }
}

// Sets are judged by radius - depth, a quick bound of the overhang that is a little above the figure
// reported.
constexpr double kSlack = 1.02;

TEST(Combined, OnOneLevelItIsAsGoodAsTheBestOfItsReducers) {
  for (const medial::Surface& surface :
       {surfaceOf(models::makeGear(7)), surfaceOf(models::makeKnot(40, 8))}) {
    BuildSettings settings = naked({"grid", "spawn", "merge", "burst", "expand"});
    settings.levels = 2;
    const double combined = build(surface, settings).report.levels.at(1).metrics.overhangWorst.lower;
    for (const std::string& reducer : settings.combined.reducers) {
      const BuildResult alone = build(surface, test::quickSettings(reducer, 2));
      EXPECT_LE(combined, kSlack * alone.report.levels.at(1).metrics.overhangWorst.upper) << reducer;
    }
  }
}

TEST(Combined, TheObjectiveDecidesWhatIsSmall) {
  const medial::Surface surface = surfaceOf(models::makeGear(9));
  constexpr std::array kObjectives{Objective::Worst, Objective::Mean, Objective::Volume};
  std::vector<std::vector<medial::Ball>> sets;
  for (const Objective objective : kObjectives) {
    BuildSettings settings = naked({"grid", "spawn", "merge", "burst", "expand"});
    settings.levels = 2;
    settings.objective = objective;
    sets.push_back(ballsOf(build(surface, settings).tree.level(1)));
  }
  for (std::size_t mine = 0; mine < sets.size(); ++mine) {
    for (std::size_t other = 0; other < sets.size(); ++other) {
      EXPECT_LE(setError(surface, sets[mine], kObjectives[mine]).first,
                kSlack * setError(surface, sets[other], kObjectives[mine]).first)
          << mine << " against " << other;
    }
  }
}

TEST(Combined, RefinementIsAGain) {
  const medial::Surface surface = surfaceOf(models::makeKnot(40, 8));
  const auto built = [&](Toggle refine, Toggle link) {
    BuildSettings settings = naked({"expand"});
    settings.refine = refine;
    settings.link = link;
    return build(surface, settings).report.levels;
  };
  const auto plain = built(Toggle::Off, Toggle::Off);
  const auto refined = built(Toggle::On, Toggle::Off);
  const auto linked = built(Toggle::On, Toggle::On);
  // Node by node the first level is what gains for sure: it decides the regions of the next.
  EXPECT_LT(refined.at(1).metrics.overhangWorst.upper, plain.at(1).metrics.overhangWorst.lower);
  EXPECT_LT(linked.at(1).metrics.overhangWorst.upper, plain.at(1).metrics.overhangWorst.lower);
  EXPECT_LT(linked.at(2).metrics.overhangWorst.upper, plain.at(2).metrics.overhangWorst.lower);
}

}  // namespace
}  // namespace spheretree::builders
