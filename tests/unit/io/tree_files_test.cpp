// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/tree_files.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <spheretree/version.hpp>

#include "test_folder.hpp"

namespace spheretree::io {
namespace {

using builders::BuildResult;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

/// A root with two children, all figures made up: this is about writing them down.
BuildResult someBuild() {
  const std::vector<SphereTree::Entry> entries = {
      {{{0, 0, 0}, 2}, kNoParent}, {{{-1, 0, 0.1F}, 1}, 0}, {{{1, 0, 0}, 1}, 0}};
  Result<SphereTree> tree = SphereTree::create(entries);
  BuildResult build{std::move(*tree), {}};
  build.report.settings.builder = "hubbard";
  build.report.settings.levels = 2;
  build.report.settings.branch = 2;
  for (const std::size_t spheres : {1U, 2U}) {
    builders::LevelReport level;
    level.metrics.spheres = spheres;
    level.metrics.overhangWorst = {0.5, 0.625};
    level.metrics.overhangMean = 0.25;
    level.metrics.surface.certified = true;
    level.metrics.surface.effort = {100, 3};
    level.metrics.solid.uncovered = {0.125, 0.25};
    level.metrics.volumeRatio = 1.5;
    level.winners = {{"merge", 2}, {"burst", 0}};
    build.report.levels.push_back(level);
  }
  build.report.surfaceChains.certified = true;
  build.report.surfaceChains.effort = {1234, 5};
  build.report.stages = {{"build", 0.25}};
  return build;
}

/// A mesh with a diagonal of exactly 10.
Provenance someProvenance() {
  Provenance provenance;
  provenance.meshPath = "models/some.obj";
  provenance.import.contentHash = "00112233445566778899aabbccddeeff";
  provenance.check.triangles = 12;
  provenance.check.closed = true;
  provenance.check.genus = 1;
  provenance.check.bounds = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(6, 8, 0)};
  provenance.repair = Repair::Fill;
  provenance.repairActions = {"Filled 1 hole with 2 triangles."};
  return provenance;
}

std::optional<std::string> valueOf(const SphFile& file, const std::string& key) {
  for (const auto& [name, value] : file.metadata)
    if (name == key) return value;
  return std::nullopt;
}

class TreeFiles : public tests::InFolder {};

TEST_F(TreeFiles, WhatIsWrittenReadsBackWithItsMetadata) {
  const BuildResult build = someBuild();
  const Result<std::string> text = formatTree(build, someProvenance());
  ASSERT_TRUE(text.ok()) << text.error().message;
  const Result<SphFile> file = readTree(put("a.sph", text.value()));
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(treeHash(file.value().tree), treeHash(build.tree));
  EXPECT_EQ(file.value().branch, 2U);
  EXPECT_EQ(valueOf(file.value(), "format-version"), "1");
  EXPECT_EQ(valueOf(file.value(), "tool"), "spheretree " SPHERETREE_VERSION);
  EXPECT_EQ(valueOf(file.value(), "mesh-hash"), "00112233445566778899aabbccddeeff");
  EXPECT_EQ(valueOf(file.value(), "mesh-triangles"), "12");
  EXPECT_EQ(valueOf(file.value(), "repair"), "fill");
  EXPECT_EQ(valueOf(file.value(), "builder"), "hubbard");
  EXPECT_EQ(valueOf(file.value(), "settings"),
            "branch=2 levels=2 max-error=0 cover=surface seed=1 quality=normal objective=worst refine=off "
            "link=off samples=2000");
  EXPECT_EQ(valueOf(file.value(), "frame"), "mesh");
  EXPECT_EQ(valueOf(file.value(), "units"), "mesh units");
  EXPECT_EQ(valueOf(file.value(), "level-1"),
            "spheres=2 overhang-worst=[0.05,0.0625] overhang-mean=0.025 volume-ratio=1.5 covered=yes "
            "solid-covered=no");
  EXPECT_EQ(valueOf(file.value(), "level-2"), std::nullopt);
  EXPECT_EQ(valueOf(file.value(), "surface-chains"), "certified");
  EXPECT_EQ(valueOf(file.value(), "solid-chains"), "not certified");
}

TEST_F(TreeFiles, SettingsAreThoseThatWereUsed) {
  BuildResult build = someBuild();
  const auto line = [&] {
    return valueOf(parseSph(formatTree(build, someProvenance()).value()).value(), "settings");
  };
  const std::string common = "branch=2 levels=2 max-error=0 cover=surface seed=1";
  build.report.settings.builder = "octree";
  EXPECT_EQ(line(), common);
  build.report.settings.builder = "combined";
  build.report.settings.combined.reducers = {"expand", "merge"};
  build.report.settings.quality = builders::Quality::Best;
  build.report.settings.objective = builders::Objective::Volume;
  build.report.settings.axis = {0.25, 77};
  EXPECT_EQ(line(), common +
                        " quality=best objective=volume refine=on link=on reducers=merge,expand "
                        "axis-error=0.25 axis-balls=77");
  build.report.settings.combined.reducers = {"grid"};
  build.report.settings.refine = builders::Toggle::Off;
  EXPECT_EQ(line(),
            common + " quality=best objective=volume refine=off link=off reducers=grid orientations=12");
}

TEST_F(TreeFiles, TheBytesDependOnTheTreeAlone) {
  BuildResult build = someBuild();
  Provenance provenance = someProvenance();
  const std::string first = formatTree(build, provenance).value();
  build.report.threads = 64;
  build.report.stages = {{"build", 17}};
  provenance.meshPath = "/elsewhere/some.obj";
  EXPECT_EQ(formatTree(build, provenance).value(), first);
  EXPECT_THAT(first, testing::Not(HasSubstr("some.obj")));
}

TEST_F(TreeFiles, UnreadableTreesAreNamed) {
  const Result<SphFile> missing = readTree(in("none.sph"));
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.error().message, StartsWith(in("none.sph").string() + ": No such file"));
  const Result<SphFile> broken = readTree(put("b.sph", "RIFF not a tree"));
  ASSERT_FALSE(broken.ok());
  EXPECT_EQ(broken.error().code, ErrorCode::UnreadableInput);
  EXPECT_THAT(broken.error().message, StartsWith(in("b.sph").string() + ": "));
}

TEST(TreeHash, SeesEveryBitAndEveryLink) {
  using Entries = std::vector<SphereTree::Entry>;
  const Entries base = {
      {{{0, 0, 0}, 2}, kNoParent}, {{{1, 0, 0}, 1}, 0}, {{{2, 0, 0}, 1}, 0}, {{{3, 0, 0}, 1}, 1}};
  const auto hash = [](const Entries& entries) { return treeHash(SphereTree::create(entries).value()); };
  EXPECT_EQ(hash(base), hash(base));
  Entries bit = base;
  bit[3].ball.radius = std::nextafter(1.0F, 2.0F);
  EXPECT_NE(hash(bit), hash(base));
  Entries link = base;
  link[3].parent = 2;
  EXPECT_NE(hash(link), hash(base));
  EXPECT_NE(hash({base.begin(), base.end() - 1}), hash(base));
}

TEST(JsonReport, HoldsWhatTheDocsPromise) {
  const BuildResult build = someBuild();
  const std::string text = formatJsonReport(build, someProvenance());
  EXPECT_TRUE(text.ends_with("}\n"));
  const nlohmann::json report = nlohmann::json::parse(text);
  EXPECT_EQ(report["tool"]["version"], SPHERETREE_VERSION);
  EXPECT_TRUE(report["tool"]["git_revision"].is_string());
  EXPECT_EQ(report["mesh"]["path"], "models/some.obj");
  EXPECT_EQ(report["mesh"]["content_hash"], "00112233445566778899aabbccddeeff");
  EXPECT_EQ(report["mesh"]["triangles"], 12);
  EXPECT_EQ(report["mesh"]["closed"], true);
  EXPECT_EQ(report["mesh"]["genus"], 1);
  EXPECT_EQ(report["mesh"]["diagonal"], 10.0);
  EXPECT_EQ(report["mesh"]["bounds"]["max"], (std::vector<double>{6, 8, 0}));
  EXPECT_EQ(report["mesh"]["repair"]["rule"], "fill");
  EXPECT_EQ(report["mesh"]["repair"]["actions"].size(), 1U);
  EXPECT_EQ(report["settings"]["samples"], 2000);
  EXPECT_FALSE(report["settings"].contains("orientations")) << "belongs to another builder";
  EXPECT_FALSE(report["settings"].contains("reducers")) << "belongs to another builder";
  EXPECT_EQ(report["settings"]["refine"], "off");
  ASSERT_EQ(report["levels"].size(), 2U);
  const nlohmann::json& level = report["levels"][1];
  EXPECT_EQ(level["spheres"], 2);
  EXPECT_EQ(level["overhang_worst"]["upper"], 0.625);
  EXPECT_EQ(level["overhang_worst_relative"]["upper"], 0.0625);
  EXPECT_EQ(level["surface_cover"]["certified"], true);
  EXPECT_EQ(level["surface_cover"]["cells"], 100);
  EXPECT_EQ(level["solid_cover"]["uncovered"]["upper"], 0.25);
  EXPECT_EQ(level["winners"]["merge"], 2);
  EXPECT_EQ(report["certificate"]["surface_chains"]["cells"], 1234);
  EXPECT_EQ(report["certificate"]["surface_chains"]["deepest_subdivision"], 5);
  EXPECT_EQ(report["stages"][0]["seconds"], 0.25);
  EXPECT_GT(report["peak_memory_bytes"], 1'000'000);
  EXPECT_EQ(report["tree"]["content_hash"], treeHash(build.tree));
  EXPECT_EQ(report["tree"]["spheres"], 3);
}

TEST(JsonReport, SaysWhatAutoMeant) {
  BuildResult build = someBuild();
  build.report.settings.builder = "combined";
  build.report.settings.combined.reducers = {"expand", "burst", "merge"};
  build.report.settings.axis = {0.25, 77};
  const nlohmann::json settings =
      nlohmann::json::parse(formatJsonReport(build, someProvenance())).at("settings");
  EXPECT_EQ(settings.at("quality"), "normal");
  EXPECT_EQ(settings.at("objective"), "worst");
  EXPECT_EQ(settings.at("refine"), "on");
  EXPECT_EQ(settings.at("link"), "on");
  EXPECT_EQ(settings.at("reducers"), (std::vector<std::string>{"merge", "burst", "expand"}));
  EXPECT_EQ(settings.at("axis_error"), 0.25);
  EXPECT_EQ(settings.at("axis_balls"), 77);
  EXPECT_FALSE(settings.contains("samples"));
}

TEST(JsonReport, SurvivesAnyPath) {
  Provenance provenance = someProvenance();
  provenance.meshPath = "a\"\\\n\xff.obj";
  EXPECT_TRUE(nlohmann::json::accept(formatJsonReport(someBuild(), provenance)));
}

TEST(CsvReport, HasOneRowPerLevelAndAsManyCellsAsItsHeader) {
  const std::string text = formatCsvReport(someBuild(), someProvenance());
  std::istringstream lines(text);
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(line);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_THAT(rows[0], StartsWith("level,spheres,overhang_worst_lower,"));
  for (const std::string& row : rows)
    EXPECT_EQ(std::count(row.begin(), row.end(), ','), std::count(rows[0].begin(), rows[0].end(), ','));
  EXPECT_THAT(rows[2], StartsWith("1,2,0.5,0.625,0.25,0.05,0.0625,0.025,1.5,1,0,0,0,0.125,0.25,0011"));
  EXPECT_THAT(rows[0], EndsWith(",tree_hash,winners"));
  EXPECT_THAT(rows[2], EndsWith(",merge=2 burst=0"));
}

}  // namespace
}  // namespace spheretree::io
