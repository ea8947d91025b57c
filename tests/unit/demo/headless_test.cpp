// SPDX-License-Identifier: GPL-3.0-or-later
#include "runtime/demo/headless.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/unit/demo/room_library.hpp"

namespace crowded_room {
namespace {

namespace fs = std::filesystem;

HeadlessSettings shortRun() {
  HeadlessSettings settings;
  settings.room.objects = 300;
  settings.room.size = {20, 10, 20};
  settings.frames = 50;
  settings.warmUp = 10;
  return settings;
}

HeadlessReport run(const HeadlessSettings& settings) {
  const spheretree::Result<HeadlessReport> report = runHeadless(settings, test::library());
  EXPECT_TRUE(report.ok()) << report.error().message;
  return *report;
}

TEST(HeadlessTest, MeasuresTheRunThatARoomMakes) {
  const HeadlessSettings settings = shortRun();
  const HeadlessReport report = run(settings);
  Room room = test::makeRoom(settings.room);
  std::uint64_t pairs = 0;
  for (std::uint32_t frame = 0; frame < 60; ++frame) {
    ASSERT_TRUE(room.step().ok());
    if (frame >= 10) pairs += room.report().pairs;
  }
  EXPECT_EQ(report.stateHash, room.stateHash());
  EXPECT_DOUBLE_EQ(report.pairsPerFrame, static_cast<double>(pairs) / 50);
  EXPECT_EQ(report.audit.outside, 0U);
  EXPECT_EQ(report.audit.changedSpeeds, 0U);
  EXPECT_EQ(report.bunnyTree, "snowman");
  EXPECT_EQ(report.boxTree, "box-built-in");
}

TEST(HeadlessTest, PhasesAddUpToTheCollisionTime) {
  const HeadlessReport report = run(shortRun());
  const double sum = report.update.mean + report.broad.mean + report.narrow.mean;
  EXPECT_NEAR(report.collision.mean, sum, 1e-3 * sum);
  EXPECT_GT(report.broad.median, 0);
  EXPECT_GE(report.collision.p99, report.collision.median);
  EXPECT_DOUBLE_EQ(report.fpsOfMean(), 1e6 / report.collision.mean);
  EXPECT_GT(report.processor.mean, 0);
  EXPECT_FALSE(report.render.has_value());
  EXPECT_FALSE(report.fpsRendered().has_value());
}

TEST(HeadlessTest, AsksForEveryMeasuredFrameToBeRendered) {
  HeadlessSettings settings = shortRun();
  int frames = 0;
  settings.render = [&](const Room& room) {
    EXPECT_EQ(room.stepsMade(), 11U + static_cast<unsigned>(frames));
    ++frames;
    return 1000.0F;
  };
  const HeadlessReport report = run(settings);
  EXPECT_EQ(frames, 50);
  ASSERT_TRUE(report.render.has_value());
  EXPECT_DOUBLE_EQ(report.render->mean, 1000);
  EXPECT_TRUE(report.renderProcessor.has_value());
  EXPECT_LT(*report.fpsRendered(), 1000);
  EXPECT_GT(*report.fpsRendered(), 1);
}

TEST(HeadlessTest, NeedsAFrame) {
  HeadlessSettings settings = shortRun();
  settings.frames = 0;
  EXPECT_EQ(runHeadless(settings, test::library()).error().message, "frames is 0; it may be 1 or more");
  settings = shortRun();
  settings.room.levels = 0;
  EXPECT_FALSE(runHeadless(settings, test::library()).ok());
}

TEST(SatisfactionTest, FollowsTableOne) {
  EXPECT_EQ(satisfactionAt(9.9), "low");
  EXPECT_EQ(satisfactionAt(10), "good");
  EXPECT_EQ(satisfactionAt(25.5), "good");
  EXPECT_EQ(satisfactionAt(26), "very good");
  EXPECT_EQ(satisfactionAt(40), "very good");
  EXPECT_EQ(satisfactionAt(41), "high");
}

class ReportFileTest : public testing::Test {
 protected:
  ~ReportFileTest() override { fs::remove_all(folder_); }

  fs::path folder_ = [] {
    const auto* const info = testing::UnitTest::GetInstance()->current_test_info();
    fs::path made = fs::path(testing::TempDir()) / (std::string("room-report-") + info->name());
    fs::create_directories(made);
    return made;
  }();
};

TEST_F(ReportFileTest, IsJsonThatSaysWhatWasRun) {
  HeadlessSettings settings = shortRun();
  settings.room.broadPhase = spheretree::BroadPhaseKind::GridSweep;
  settings.room.budget.sphereTests = 5000;
  const HeadlessReport report = run(settings);
  const fs::path file = folder_ / "report.json";
  ASSERT_TRUE(writeReport(report, file).ok());
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
  EXPECT_EQ(json["format"], "crowded_room 1");
  EXPECT_EQ(json["frames"], 50);
  EXPECT_EQ(json["settings"]["objects"], 300);
  EXPECT_EQ(json["settings"]["broad_phase"], "grid_sweep");
  EXPECT_EQ(json["settings"]["grid"], (nlohmann::json{10, 4, 10}));
  EXPECT_EQ(json["settings"]["budget"]["sphere_tests"], 5000);
  EXPECT_TRUE(json["settings"]["budget"]["microseconds"].is_null());
  EXPECT_EQ(json["settings"]["bunny_tree"], "snowman");
  EXPECT_NEAR(json["microseconds"]["collision"]["mean"], report.collision.mean, 1e-4 * report.collision.mean);
  EXPECT_NEAR(json["fps"]["of_60_by_mean"], report.fpsOfMean() / 60, 1e-4 * report.fpsOfMean());
  EXPECT_FALSE(json["microseconds"].contains("render"));
  EXPECT_EQ(json["audit"]["outside"], 0);
  EXPECT_EQ(json["state_hash"].get<std::string>().size(), 16U);
}

TEST_F(ReportFileTest, ReplacesAnOldReportAndLeavesNothingElse) {
  const fs::path file = folder_ / "report.json";
  std::ofstream(file) << "old";
  ASSERT_TRUE(writeReport(run(shortRun()), file).ok());
  EXPECT_TRUE(nlohmann::json::accept(std::ifstream(file)));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(ReportFileTest, NamesTheFileThatCannotBeWritten) {
  const HeadlessReport report = run(shortRun());
  const fs::path nowhere = folder_ / "missing" / "report.json";
  EXPECT_EQ(writeReport(report, nowhere).error().message, nowhere.string() + ": cannot be written");
  EXPECT_EQ(writeReport(report, folder_).error().message, folder_.string() + ": is a folder");
}

}  // namespace
}  // namespace crowded_room
