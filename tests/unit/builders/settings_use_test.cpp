// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/settings_use.hpp"

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "builders/catalogue.hpp"
#include "tests/unit/builders/solids.hpp"

namespace spheretree::builders {
namespace {

using Names = std::vector<std::string_view>;

BuildSettings combinedOf(std::vector<std::string> reducers) {
  BuildSettings settings;
  settings.builder = "combined";
  settings.combined.reducers = std::move(reducers);
  return settings;
}

BuildSettings alone(std::string_view builder) {
  BuildSettings settings;
  settings.builder = builder;
  return settings;
}

TEST(SettingsUse, ReducersComeInTheOrderOfTheCatalogue) {
  EXPECT_EQ(reducersInUse(combinedOf({"expand", "grid", "merge"})), (Names{"grid", "merge", "expand"}));
  EXPECT_EQ(reducersInUse(alone("hubbard")), Names{"hubbard"});
  EXPECT_EQ(reducersInUse(alone("octree")), Names{});
}

TEST(SettingsUse, TheAxisIsUsedWhenAReducerWantsIt) {
  const medial::Surface surface = boxSurface(1, 1, 1);
  const medial::Context context(1);
  for (const CatalogueEntry& entry : catalogue()) {
    SCOPED_TRACE(entry.name);
    if (entry.makeReducer == nullptr) continue;
    const BuildSettings settings = alone(entry.name);
    EXPECT_EQ(usesAxis(settings), entry.makeReducer(surface, settings, context)->wantsAxis());
    EXPECT_EQ(usesAxis(combinedOf({std::string(entry.name)})), usesAxis(settings));
  }
  EXPECT_FALSE(usesAxis(alone("octree")));
  EXPECT_TRUE(usesAxis(combinedOf({"grid", "merge"})));
}

TEST(SettingsUse, AutoRefinesAndLinksCombinedOnly) {
  const BuildSettings combined = combinedOf({"merge"});
  EXPECT_TRUE(refines(combined));
  EXPECT_TRUE(links(combined));
  EXPECT_FALSE(refines(alone("merge")));
  EXPECT_FALSE(links(alone("merge")));

  BuildSettings settings = alone("merge");
  settings.refine = Toggle::On;
  EXPECT_TRUE(refines(settings));
  EXPECT_FALSE(links(settings));
  settings.link = Toggle::On;
  EXPECT_TRUE(links(settings));

  settings = combined;
  settings.refine = Toggle::Off;
  EXPECT_FALSE(refines(settings));
  EXPECT_FALSE(links(settings)) << "there is nothing to link without refining";
  EXPECT_EQ(whyInvalid(settings), "");

  settings = alone("octree");
  settings.refine = Toggle::On;
  settings.link = Toggle::On;
  EXPECT_FALSE(refines(settings));
  EXPECT_FALSE(links(settings));
}

TEST(SettingsUse, DefaultsAreValidForEveryBuilder) {
  for (const CatalogueEntry& entry : catalogue()) EXPECT_EQ(whyInvalid(alone(entry.name)), "") << entry.name;
}

TEST(SettingsUse, ReducersMustBeKnownAndNamedOnce) {
  EXPECT_NE(whyInvalid(combinedOf({})).find("at least one"), std::string::npos);
  EXPECT_NE(whyInvalid(combinedOf({"merge", "burts"})).find("'burts'"), std::string::npos);
  EXPECT_NE(whyInvalid(combinedOf({"merge", "expand", "merge"})).find("'merge' is named twice"),
            std::string::npos);
  for (const char* name : {"octree", "combined"}) {
    const std::string reason = whyInvalid(combinedOf({name}));
    EXPECT_NE(reason.find("'" + std::string(name) + "' is no reducer"), std::string::npos) << reason;
    EXPECT_EQ(reason.find(std::string(name) + ","), std::string::npos) << "offered: " << reason;
  }
}

TEST(SettingsUse, LinkNeedsRefine) {
  BuildSettings settings = combinedOf({"merge"});
  settings.link = Toggle::On;
  EXPECT_EQ(whyInvalid(settings), "");
  settings.refine = Toggle::Off;
  EXPECT_NE(whyInvalid(settings).find("link needs refine"), std::string::npos);
  settings = alone("grid");
  settings.link = Toggle::On;
  EXPECT_NE(whyInvalid(settings).find("unless set to on"), std::string::npos);
  settings.refine = Toggle::On;
  EXPECT_EQ(whyInvalid(settings), "");
}

TEST(SettingsUse, TheAxisErrorIsAPositiveNumber) {
  BuildSettings settings;
  for (const double error :
       {0.0, -0.5, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    settings.axis.error = error;
    EXPECT_NE(whyInvalid(settings).find("axis-error"), std::string::npos) << error;
  }
  settings.axis.error = 1.5;
  EXPECT_EQ(whyInvalid(settings), "");
}

}  // namespace
}  // namespace spheretree::builders
