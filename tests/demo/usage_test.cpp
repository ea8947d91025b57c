// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "options.hpp"
#include "tests/cli/program.hpp"

namespace crowded_room {
namespace {

using spheretree::tests::Finished;
using Words = std::vector<std::string>;

class RoomUsage : public spheretree::tests::ProgramTest {};

TEST_F(RoomUsage, HelpNamesEveryOption) {
  const Finished help = run({"--help"});
  EXPECT_EQ(help.exitCode, 0);
  EXPECT_EQ(help.err, "");
  for (const char* word :
       {"--objects", "--broad", "--trees", "--levels", "--mix", "--movement", "--speed", "--seed",
        "--threads", "--headless", "--frames", "--report", "--screenshot", "--size", "--record"})
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
}

TEST_F(RoomUsage, AMistakeIsOneSentenceAndExitCode2) {
  const std::vector<Words> mistakes{{"--object", "3"},
                                    {"  room"},
                                    {"--objects"},
                                    {"--objects", "many"},
                                    {"--objects", "-1"},
                                    {"--objects=3x"},
                                    {"--objects", "99999999999"},
                                    {"--headless=yes"},
                                    {"--broad", "quadtree"},
                                    {"--mix", "1.5", "--headless"},
                                    {"--speed", "nan", "--headless"},
                                    {"--levels", "0"},
                                    {"--movement", "xy"},
                                    {"--size", "320"},
                                    {"--size", "0x10"},
                                    {"--frames", "0"},
                                    {"--look", "points"},
                                    {"--bunny-tree", "hare", "--headless"}};
  for (const Words& words : mistakes) {
    const Finished finished = run(words);
    EXPECT_EQ(finished.exitCode, 2) << words.back();
    EXPECT_EQ(finished.err.rfind("crowded_room: ", 0), 0U) << finished.err;
    EXPECT_NE(finished.err.find(words.front() == "--bunny-tree" ? "hare" : words.front().substr(2, 5)),
              std::string::npos)
        << finished.err;
    EXPECT_EQ(finished.out, "");
  }
}

TEST_F(RoomUsage, SaysWhatAWordMayBe) {
  EXPECT_NE(run({"--broad", "quadtree"}).err.find("sweep_and_prune"), std::string::npos);
  EXPECT_NE(run({"--look", "points"}).err.find("mesh, balls"), std::string::npos);
}

TEST_F(RoomUsage, RunsWithoutADisplayAndReports) {
  const Finished finished = run({"--headless", "--objects=200", "--frames", "30", "--report", "out.json"});
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_NE(finished.out.find("200 objects, 30 frames"), std::string::npos) << finished.out;
  const auto report = nlohmann::json::parse(read("out.json"));
  EXPECT_EQ(report["frames"], 30);
  EXPECT_EQ(names(), Words{"out.json"}) << "nothing else is written";
}

TEST_F(RoomUsage, WithoutTreesItSaysHowToMakeThem) {
  const Finished finished = run({"--headless", "--frames", "1", "--trees", "nowhere"});
  EXPECT_EQ(finished.exitCode, 3);
  EXPECT_NE(finished.err.find("nowhere: no sphere trees there; make them with `spheretree build"),
            std::string::npos)
      << finished.err;
}

TEST_F(RoomUsage, FindsTheTreesOfTheQuickStart) {
  std::filesystem::create_directories(folder_ / "build/run");
  write("build/run/bunny-1500.sph", spheretree::tests::classicBoxTree());
  const Finished finished = run({"--report", "out.json", "--frames", "1", "--objects", "10"});
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  EXPECT_NE(read("out.json").find("bunny-1500"), std::string::npos);
}

TEST_F(RoomUsage, AReportThatCannotBeWrittenIsNamed) {
  const Finished finished = run({"--frames", "1", "--objects", "10", "--report", "missing/out.json"});
  EXPECT_EQ(finished.exitCode, 6);
  EXPECT_NE(finished.err.find("missing/out.json"), std::string::npos) << finished.err;
}

TEST_F(RoomUsage, WithoutADisplayTheWindowSaysWhatDoes) {
  const Finished finished = finish(
      start("/usr/bin/env", {"SDL_VIDEODRIVER=dummy", spheretree::tests::programPath(), "--frames", "1"}));
  EXPECT_EQ(finished.exitCode, 2);
  EXPECT_NE(finished.err.find("--headless and --screenshot need none"), std::string::npos) << finished.err;
}

TEST(RoomOptions, DefaultsAreThoseOfTheRoom) {
  const auto options = parseOptions({});
  ASSERT_TRUE(options.ok());
  EXPECT_EQ(options->mode, Mode::Window);
  EXPECT_EQ(options->room.objects, RoomSettings{}.objects);
  const std::string help = helpText();
  for (const std::string& stated :
       {"objects in the room [" + std::to_string(options->room.objects) + "]",
        "is drawn; the root counts [" + std::to_string(options->room.levels) + "]",
        "[" + std::to_string(options->size.width) + "x" + std::to_string(options->size.height) + "]",
        "[" + std::to_string(Options::kHeadlessFrames) + " without a window]"}) {
    SCOPED_TRACE(stated);
    EXPECT_NE(help.find(stated.substr(stated.find('['))), std::string::npos);
  }
}

TEST(RoomOptions, EveryLineOfTheHelpFitsATerminal) {
  const std::string help = helpText();
  for (std::size_t start = 0; start < help.size();) {
    const std::size_t end = help.find('\n', start);
    EXPECT_LE(end - start, 120U) << help.substr(start, end - start);
    start = end + 1;
  }
}

}  // namespace
}  // namespace crowded_room
