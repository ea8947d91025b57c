// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/types.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace spheretree::tests {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Arguments = std::vector<std::string>;
using Files = std::map<std::string, std::string>;

/// A box stretched along x: another mesh for every length.
std::string stretchedBox(double length) {
  return "v 0 0 0\nv " + std::to_string(length) + " 0 0\nv " + std::to_string(length) +
         " 1 0\nv 0 1 0\nv 0 0 1\nv " + std::to_string(length) + " 0 1\nv " + std::to_string(length) +
         " 1 1\nv 0 1 1\nf 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n";
}

class Batch : public ProgramTest {
 protected:
  /// The octree of few levels: these tests are about the program, not about the trees.
  Finished batch(const Arguments& more, const std::string& where = ".") {
    Arguments arguments{"batch", "--builder", "octree", "--levels", "3", "--threads", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, where);
  }

  /// box.obj, sub/long.obj, sub/deep/longer.obj, and a file that is no mesh.
  void writeLibrary() {
    fs::create_directories(folder_ / "in/sub/deep");
    write("in/box.obj", boxObj());
    write("in/sub/long.obj", stretchedBox(2));
    write("in/sub/deep/longer.obj", stretchedBox(3));
    write("in/readme.txt", "nothing to see\n");
  }

  /// All files below, hidden ones included, by name relative to `folder`.
  [[nodiscard]] Files filesBelow(const std::string& folder) const {
    Files files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / folder)) {
      if (!entry.is_regular_file()) continue;
      const std::string name = entry.path().lexically_relative(folder_ / folder).string();
      files[name] = read(folder + "/" + name);
    }
    return files;
  }

  /// Those without the clock: all but the summaries.
  [[nodiscard]] Files lastingFiles(const std::string& folder) const {
    Files files = filesBelow(folder);
    for (const char* name : {"summary.json", "summary.csv", "summary.html"}) files.erase(name);
    return files;
  }

  [[nodiscard]] Json summary(const std::string& name = "out/summary.json") const {
    return Json::parse(read(name));
  }

  /// A summary without what the clock and the machine decide.
  [[nodiscard]] Json lastingSummary(const std::string& name) const {
    Json json = summary(name);
    json.erase("run");
    return json;
  }
};

std::vector<std::string> namesOf(const Files& files) {
  std::vector<std::string> names;
  for (const auto& [name, text] : files) names.push_back(name);
  return names;
}

TEST_F(Batch, AFolderIsMirroredWithARecordBesideEveryTree) {
  writeLibrary();
  const Finished finished = batch({"in", "-o", "out"});
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_EQ(namesOf(lastingFiles("out")),
            (std::vector<std::string>{"box.report.json", "box.sph", "sub/deep/longer.report.json",
                                      "sub/deep/longer.sph", "sub/long.report.json", "sub/long.sph"}));
  EXPECT_NE(finished.out.find("3 assets: 3 done\n"), std::string::npos) << finished.out;
  // Plain lines where there is no terminal, one per asset.
  EXPECT_NE(finished.err.find("[3/3] "), std::string::npos) << finished.err;
  EXPECT_EQ(finished.err.find('\r'), std::string::npos);
}

TEST_F(Batch, TreesAreThoseOfBuild) {
  writeLibrary();
  ASSERT_EQ(batch({"in", "-o", "out"}).exitCode, 0);
  ASSERT_EQ(
      run({"build", "in/sub/long.obj", "-o", "alone.sph", "--builder", "octree", "--levels", "3"}).exitCode,
      0);
  EXPECT_EQ(read("alone.sph"), read("out/sub/long.sph"));
}

TEST_F(Batch, TheSummarySaysWhatTheRecordsSay) {
  writeLibrary();
  write("in/broken.obj", "no mesh\n");
  EXPECT_EQ(batch({"in", "-o", "out"}).exitCode, 7);
  const Json all = summary();
  EXPECT_EQ(all.at("totals").at("assets"), 4);
  EXPECT_EQ(all.at("totals").at("done"), 3);
  EXPECT_EQ(all.at("totals").at("failed"), 1);
  const std::string csv = read("out/summary.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 4);
  for (const Json& asset : all.at("assets")) {
    const Json record = Json::parse(read("out/" + asset.at("record").get<std::string>()));
    EXPECT_EQ(record.at("batch").at("state"), asset.at("state"));
    if (asset.at("output") == "broken.sph") {
      EXPECT_EQ(asset.at("reason"), "in/broken.obj: holds no polygon");
      EXPECT_EQ(asset.at("trouble"), "unreadable_input");
      EXPECT_FALSE(exists("out/broken.sph"));
      continue;
    }
    EXPECT_EQ(asset.at("state"), "done");
    ASSERT_EQ(asset.at("levels").size(), 3U);
    EXPECT_TRUE(asset.at("levels").at(2).at("surface_certified").get<bool>());
    EXPECT_EQ(asset.at("levels").at(0).at("overhang_worst"),
              record.at("levels").at(0).at("overhang_worst").at("upper"));
    EXPECT_EQ(asset.at("tree").at("bytes"), read("out/" + asset.at("output").get<std::string>()).size());
  }
}

TEST_F(Batch, ASecondRunSkipsAllAndChangesNothing) {
  writeLibrary();
  write("in/broken.obj", "no mesh\n");
  ASSERT_EQ(batch({"in", "-o", "out"}).exitCode, 7);
  const Files before = lastingFiles("out");
  const Json first = summary();
  const Finished again = batch({"in", "-o", "out"});
  EXPECT_EQ(again.exitCode, 7);
  EXPECT_NE(again.out.find("4 of them skipped"), std::string::npos) << again.out;
  EXPECT_EQ(lastingFiles("out"), before);
  const Json second = summary();
  for (std::size_t k = 0; k < 4; ++k) {
    const Json& run = second.at("run").at("assets").at(k);
    EXPECT_EQ(run.at("action"), "skipped");
    EXPECT_EQ(run.at("seconds"),
              first.at("run").at("assets").at(k).at("seconds"));  // of the run that built it
  }
}

TEST_F(Batch, PagesAreTheSameEveryTime) {
  writeLibrary();
  const Finished once = batch({"in", "-o", "once", "--pages", "--jobs", "1"});
  if (once.exitCode == 2) GTEST_SKIP() << once.err;
  ASSERT_EQ(once.exitCode, 0) << once.err;
  ASSERT_EQ(batch({"in", "-o", "twice", "--pages", "--jobs", "2"}).exitCode, 0);
  EXPECT_TRUE(exists("once/sub/deep/longer.report.html"));
  EXPECT_EQ(lastingFiles("once"), lastingFiles("twice"));
}

TEST_F(Batch, OnlyWhatChangedIsBuiltAgain) {
  writeLibrary();
  ASSERT_EQ(batch({"in", "-o", "out"}).exitCode, 0);
  const std::string box = read("out/box.sph");
  write("in/sub/long.obj", stretchedBox(5));      // another mesh
  write("out/sub/deep/longer.sph", "damaged\n");  // no longer what its record vouches for
  EXPECT_EQ(batch({"in", "-o", "out"}).exitCode, 0);
  std::map<std::string, std::string> actions;
  const Json all = summary();
  for (const Json& asset : all.at("run").at("assets")) actions[asset.at("output")] = asset.at("action");
  EXPECT_EQ(actions,
            (std::map<std::string, std::string>{
                {"box.sph", "skipped"}, {"sub/deep/longer.sph", "built"}, {"sub/long.sph", "built"}}));
  EXPECT_EQ(read("out/sub/deep/longer.sph").rfind("3 8\n", 0), 0U);
  // Other settings are another tree, for all.
  EXPECT_EQ(batch({"in", "-o", "out", "--branch", "4"}).exitCode, 0);
  EXPECT_NE(read("out/box.sph"), box);
}

TEST_F(Batch, ATreeOfAMeshThatWentBadGoesToo) {
  writeLibrary();
  ASSERT_EQ(batch({"in", "-o", "out"}).exitCode, 0);
  write("in/box.obj", "no mesh any more\n");
  EXPECT_EQ(batch({"in", "-o", "out"}).exitCode, 7);
  EXPECT_FALSE(exists("out/box.sph"));
  // But one that is merely away keeps it: it may be back tomorrow.
  fs::remove(folder_ / "in/sub/long.obj");
  write("list.csv", "input\nin/sub/long.obj\n");
  EXPECT_EQ(batch({"list.csv", "-o", "out/"}).exitCode, 7);
  EXPECT_TRUE(exists("out/sub/long.sph"));
}

TEST_F(Batch, OneBadAssetStopsNothingUnlessWanted) {
  fs::create_directories(folder_ / "in");
  write("in/a.obj", "no mesh\n");
  for (const char* name : {"in/b.obj", "in/c.obj"}) write(name, boxObj());
  EXPECT_EQ(batch({"in", "-o", "going", "--keep-going"}).exitCode, 7);
  EXPECT_EQ(summary("going/summary.json").at("totals").at("done"), 2);
  // A mesh that is not there fails before anything is built.
  write("list.csv", "input\nin/a_missing.obj\nin/b.obj\nin/c.obj\n");
  const Finished fast = batch({"list.csv", "-o", "fast", "--fail-fast"});
  EXPECT_EQ(fast.exitCode, 7);
  const Json all = summary("fast/summary.json");
  EXPECT_EQ(all.at("totals").at("failed"), 1);
  EXPECT_EQ(all.at("totals").at("pending"), 2);
  EXPECT_FALSE(exists("fast/in/b.sph"));
  // And can be taken up again.
  write("in/a_missing.obj", boxObj());
  EXPECT_EQ(batch({"list.csv", "-o", "fast", "--fail-fast"}).exitCode, 0);
}

TEST_F(Batch, AMissedErrorIsCodeFiveAndItsTreeIsThere) {
  fs::create_directories(folder_ / "in");
  write("in/box.obj", boxObj());
  EXPECT_EQ(batch({"in", "-o", "out", "--max-error", "0.0001"}).exitCode, 5);
  EXPECT_TRUE(exists("out/box.sph"));
  const Json asset = summary().at("assets").at(0);
  EXPECT_EQ(asset.at("state"), "missed");
  EXPECT_NE(asset.at("reason").get<std::string>().find("more than the maximal error 0.0001"),
            std::string::npos);
}

TEST_F(Batch, ADryRunSaysAllAndWritesNothing) {
  writeLibrary();
  write("in/broken.obj", "no mesh\n");
  const Finished dry = batch({"in", "-o", "out", "--dry-run"});
  EXPECT_EQ(dry.exitCode, 0) << dry.err;
  EXPECT_FALSE(exists("out"));
  EXPECT_NE(dry.out.find("4 assets, 4 to build; nothing was written\n"), std::string::npos) << dry.out;
  batch({"in", "-o", "out"});
  const Files before = filesBelow("out");
  const Finished after = batch({"in", "-o", "out", "--dry-run"});
  EXPECT_NE(after.out.find("4 assets, 0 to build"), std::string::npos) << after.out;
  EXPECT_EQ(filesBelow("out"), before);
}

TEST_F(Batch, InputsOfTheSameNameKeepTheirEndings) {
  fs::create_directories(folder_ / "in");
  write("in/box.obj", boxObj());
  ASSERT_EQ(run({"mesh", "in/box.obj", "-o", "in/box.stl"}).exitCode, 0);
  EXPECT_EQ(batch({"in", "-o", "out"}).exitCode, 0);
  EXPECT_TRUE(exists("out/box.obj.sph"));
  EXPECT_TRUE(exists("out/box.stl.sph"));
  EXPECT_FALSE(exists("out/box.sph"));
}

TEST_F(Batch, PatternsAreMirroredFromTheirFixedPart) {
  writeLibrary();
  EXPECT_EQ(batch({"in/**/l*.obj", "-o", "out"}).exitCode, 0);
  EXPECT_TRUE(exists("out/sub/long.sph"));
  EXPECT_TRUE(exists("out/sub/deep/longer.sph"));
  EXPECT_FALSE(exists("out/box.sph"));
  const Finished nothing = batch({"in/*.stl", "-o", "out"});
  EXPECT_EQ(nothing.exitCode, 3);
  EXPECT_EQ(nothing.err, "spheretree: in/*.stl: no file matches\n");
}

TEST_F(Batch, SeveralFoldersKeepTheirNames) {
  for (const char* name : {"red", "blue"}) {
    fs::create_directories(folder_ / name);
    write(std::string(name) + "/box.obj", boxObj());
  }
  EXPECT_EQ(batch({"red", "blue", "-o", "out"}).exitCode, 0);
  EXPECT_TRUE(exists("out/red/box.sph"));
  EXPECT_TRUE(exists("out/blue/box.sph"));
}

TEST_F(Batch, AManifestSettlesEveryAsset) {
  writeLibrary();
  write("list.json", R"({"defaults": {"levels": 2}, "assets": [
    {"input": "in/box.obj", "output": "furniture/box.sph", "branch": 4},
    {"input": "in/sub/long.obj", "levels": 3, "cover": "Solid"}]})");
  EXPECT_EQ(batch({"list.json", "-o", "out"}).exitCode, 0);
  EXPECT_EQ(read("out/furniture/box.sph").rfind("2 4\n", 0), 0U);
  EXPECT_EQ(read("out/in/sub/long.sph").rfind("3 8\n", 0), 0U);
  EXPECT_NE(read("out/in/sub/long.sph").find("# solid-chains: certified"), std::string::npos);
  write("list.csv", "input,output,levels,branch\nin/box.obj,\"furniture/box.sph\",2,4\n");
  EXPECT_EQ(batch({"list.csv", "-o", "csv"}).exitCode, 0);
  EXPECT_EQ(read("csv/furniture/box.sph"), read("out/furniture/box.sph"));
}

TEST_F(Batch, AWrongManifestIsCodeTwoAndBuildsNothing) {
  writeLibrary();
  write("list.csv", "input,levels\nin/box.obj,3\nin/sub/long.obj,99\n");
  const Finished finished = batch({"list.csv", "-o", "out"});
  EXPECT_EQ(finished.exitCode, 2);
  EXPECT_EQ(finished.err, "spheretree: list.csv: line 3, levels: '99' is not a whole number in [1, 24]\n");
  EXPECT_FALSE(exists("out"));
}

TEST_F(Batch, ForeignFilesAreNotReplaced) {
  writeLibrary();
  fs::create_directories(folder_ / "out");
  write("out/box.sph", "my own work\n");
  EXPECT_EQ(batch({"in", "-o", "out"}).exitCode, 7);
  EXPECT_EQ(read("out/box.sph"), "my own work\n");
  EXPECT_TRUE(exists("out/sub/long.sph"));
  EXPECT_EQ(batch({"in", "-o", "out", "--force"}).exitCode, 0);
  EXPECT_EQ(read("out/box.sph").rfind("3 8\n", 0), 0U);
  write("out/summary.csv", "my,own,table\n");
  const Finished refused = batch({"in", "-o", "out"});
  EXPECT_EQ(refused.exitCode, 6);
  EXPECT_EQ(read("out/summary.csv"), "my,own,table\n");
}

TEST_F(Batch, ShardsShareTheWorkAndTheirSummariesJoin) {
  fs::create_directories(folder_ / "in");
  for (int k = 0; k < 7; ++k) write("in/box" + std::to_string(k) + ".obj", stretchedBox(1 + k));
  ASSERT_EQ(batch({"in", "-o", "whole"}).exitCode, 0);
  std::size_t assets = 0;
  for (const char* shard : {"1", "2", "3"}) {
    ASSERT_EQ(batch({"in", "-o", "parts", "--shard", std::string(shard) + "/3"}).exitCode, 0);
    assets += summary(std::string("parts/summary-") + shard + "-of-3.json").at("assets").size();
  }
  EXPECT_EQ(assets, 7U);
  for (const auto& [name, text] : lastingFiles("whole")) EXPECT_EQ(text, read("parts/" + name)) << name;
  const Finished merged = run({"batch", "-o", "parts", "--merge-summaries", "parts/summary-3-of-3.json",
                               "parts/summary-1-of-3.json", "parts/summary-2-of-3.json"});
  EXPECT_EQ(merged.exitCode, 0) << merged.err;
  EXPECT_EQ(lastingSummary("parts/summary.json"), lastingSummary("whole/summary.json"));
  const Finished lacking = run({"batch", "-o", "parts", "--merge-summaries", "parts/summary-1-of-3.json",
                                "parts/summary-3-of-3.json"});
  EXPECT_EQ(lacking.exitCode, 2);
  EXPECT_EQ(lacking.err, "spheretree: shard 2 of 3 is missing\n");
}

TEST_F(Batch, ASceneDerivesLevelsFromItsTolerance) {
  fs::create_directories(folder_ / "in");
  write("in/box.obj", boxObj());
  write("scene.json", R"({"assets": [
    {"input": "in/box.obj", "output": "near.sph", "instances": [1, 4, 2], "tolerance": 0.5, "levels": 5},
    {"input": "in/box.obj", "output": "far.sph", "instances": 10, "scale": 0.1, "tolerance": 0.5}]})");
  const Finished finished = run({"batch", "scene.json", "-o", "out", "--builder", "octree"});
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  const Json scene = summary().at("scene");
  ASSERT_EQ(scene.at("assets").size(), 2U);
  // A box of side 0.1 lies within 0.04 of its ball: the root is enough.
  const Json& far = scene.at("assets").at(0);
  EXPECT_EQ(far.at("output"), "far.sph");
  EXPECT_EQ(far.at("levels"), 1);
  EXPECT_EQ(far.at("instances"), 10);
  EXPECT_DOUBLE_EQ(far.at("tolerance").get<double>(), 5);
  // The largest instance decides: 0.5 / 4 in units of the mesh.
  const Json& near = scene.at("assets").at(1);
  EXPECT_DOUBLE_EQ(near.at("tolerance").get<double>(), 0.125);
  EXPECT_GT(near.at("levels"), 1);
  const Json levels = summary().at("assets").at(1).at("levels");  // a copy
  EXPECT_LE(levels.back().at("overhang_worst").get<double>(), 0.125);
  EXPECT_GT(levels.at(levels.size() - 2).at("overhang_worst").get<double>(), 0.125);
  const Json& totals = scene.at("totals");
  EXPECT_EQ(totals.at("instances"), 13);
  EXPECT_LT(totals.at("runtime_bytes"), totals.at("full_runtime_bytes"));
  EXPECT_LT(totals.at("sphere_tests").get<double>(), totals.at("full_sphere_tests").get<double>());
}

TEST_F(Batch, InstancesOfAMeshShareATree) {
  fs::create_directories(folder_ / "in");
  write("in/box.obj", boxObj());
  write("scene.csv", "input,instances,scale,tolerance\nin/box.obj,2,1,0.3\nin/box.obj,3,2,0.3\n");
  EXPECT_EQ(run({"batch", "scene.csv", "-o", "out", "--builder", "octree"}).exitCode, 0);
  const Json scene = summary().at("scene").at("assets");
  ASSERT_EQ(scene.size(), 1U);
  EXPECT_EQ(scene.at(0).at("instances"), 5);
  EXPECT_DOUBLE_EQ(scene.at(0).at("tolerance").get<double>(), 0.15);
}

/// Boxes of which each takes some hundredths of a second.
class Killed : public Batch {
 protected:
  static constexpr int kAssets = 24;

  Killed() {
    fs::create_directories(folder_ / "in/sub");
    for (int k = 0; k < kAssets; ++k)
      write((k % 2 == 0 ? "in/box" : "in/sub/box") + std::to_string(k) + ".obj", stretchedBox(1 + 0.1 * k));
    write("in/broken.obj", "no mesh\n");
  }

  [[nodiscard]] Arguments command(const std::string& output) const {
    return {"batch", "in", "-o", output, "--builder", "octree", "--levels", "4", "--threads", "2"};
  }
};

TEST_F(Killed, AtAnyMomentItGoesOnWhereItWas) {
  ASSERT_EQ(run(command("whole")).exitCode, 7);
  constexpr int kKills = 4;
  constexpr std::chrono::milliseconds kPause{70};  // moments spread over a run
  for (int k = 1; k <= kKills; ++k) {
    const pid_t process = start(programPath(), command("killed"));
    std::this_thread::sleep_for(kPause * k);
    ::kill(process, SIGKILL);
    finish(process);
  }
  ASSERT_EQ(run(command("killed")).exitCode, 7);
  EXPECT_EQ(lastingFiles("killed"), lastingFiles("whole"));  // hidden files too: nothing is left behind
  EXPECT_EQ(lastingSummary("killed/summary.json"), lastingSummary("whole/summary.json"));
}

TEST_F(Killed, LeftoversOfAKilledRunAreCleanedAndNothingElse) {
  fs::create_directories(folder_ / "out");
  write("out/.box0.sph.tmp-4711-0", "half a tree");
  write("out/.box0.report.json.tmp-4711-0", "half a record");
  write("out/.mine.sph.tmp-4711-0", "of another program");
  ASSERT_EQ(run(command("out")).exitCode, 7);
  EXPECT_FALSE(exists("out/.box0.sph.tmp-4711-0"));
  EXPECT_FALSE(exists("out/.box0.report.json.tmp-4711-0"));
  EXPECT_TRUE(exists("out/.mine.sph.tmp-4711-0"));
}

TEST_F(Killed, AnInterruptKeepsWhatIsFinished) {
  ASSERT_EQ(run(command("whole")).exitCode, 7);
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string out = "out" + std::to_string(signal);
    const pid_t process = start(programPath(), command(out));
    // The first tree is there, the others are being built.
    for (int tries = 0; tries < 10'000 && !exists(out + "/box0.sph") && !exists(out + "/sub/box1.sph");
         ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ::kill(process, signal);
    const Finished finished = finish(process);
    EXPECT_EQ(finished.exitCode, 130) << finished.err;
    EXPECT_FALSE(exists(out + "/summary.json"));
    for (const auto& [name, text] : filesBelow(out)) EXPECT_EQ(name.find(".tmp-"), std::string::npos) << name;
    ASSERT_EQ(run(command(out)).exitCode, 7);
    EXPECT_EQ(lastingFiles(out), lastingFiles("whole"));
  }
}

TEST_F(Batch, WrongUsageIsCodeTwo) {
  writeLibrary();
  const std::vector<Arguments> wrong = {{"-o", "out"},
                                        {"in"},
                                        {"in", "-o", "out", "--shard", "3/2"},
                                        {"in", "-o", "out", "--shard", "0/2"},
                                        {"in", "-o", "out", "--shard", "one"},
                                        {"in", "-o", "out", "--jobs", "-1"},
                                        {"in", "-o", "out", "--memory-limit", "much"},
                                        {"in", "-o", "out", "--timeout", "-1"},
                                        {"in", "-o", "out", "--summary", "out.xml"},
                                        {"in", "-o", "out", "--fail-fast", "--keep-going"},
                                        {"in", "-o", "out", "--merge-summaries", "a.json"}};
  for (const Arguments& arguments : wrong) {
    const Finished finished = batch(arguments);
    EXPECT_EQ(finished.exitCode, 2) << arguments.back() << ": " << finished.err;
    EXPECT_FALSE(exists("out"));
  }
  EXPECT_EQ(batch({"nowhere", "-o", "out"}).exitCode, 3);
}

TEST_F(Batch, TheRunAndItsLimitsAreInTheSummary) {
  writeLibrary();
  ASSERT_EQ(batch({"in", "-o", "out", "--jobs", "1", "--memory-limit", "3G", "--summary", "a.json",
                   "--summary", "b.csv"})
                .exitCode,
            0);
  EXPECT_FALSE(exists("out/summary.json"));
  const Json run = summary("a.json").at("run");
  EXPECT_EQ(run.at("jobs"), 1);
  EXPECT_EQ(run.at("threads"), 2);
  EXPECT_EQ(run.at("memory_limit_bytes"), 3ULL << 30U);
  EXPECT_GT(run.at("peak_memory_bytes"), 1'000'000);
  EXPECT_LT(run.at("peak_memory_bytes"), 3ULL << 30U);
}

TEST_F(Batch, WhatDoesNotFitOrTakesTooLongIsAReason) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers reserve more than any bound";
#endif
  writeLibrary();
  const Arguments deep{"batch", "in", "-o", "out", "--builder", "octree", "--levels", "6"};
  Arguments tightly = deep;
  tightly.insert(tightly.end(), {"--memory-limit", "1M"});
  const Finished tight = run(tightly);
  EXPECT_EQ(tight.exitCode, 7);
  Json all = summary();
  for (const Json& asset : all.at("assets")) EXPECT_EQ(asset.at("trouble"), "out_of_memory") << tight.out;
  // The surroundings are to blame, so it is tried again.
  const Finished again = run(deep);
  EXPECT_EQ(again.exitCode, 0) << again.out;
  const Finished late =
      run({"batch", "in", "-o", "late", "--builder", "grid", "--levels", "6", "--timeout", "0.2"});
  EXPECT_EQ(late.exitCode, 7) << late.err;
  all = summary("late/summary.json");
  for (const Json& asset : all.at("assets")) {
    EXPECT_EQ(asset.at("trouble"), "timed_out");
    EXPECT_NE(asset.at("reason").get<std::string>().find("longer than the 0.2 seconds"), std::string::npos);
  }
}

/// What the program draws on a terminal of so many columns, one piece per return to the start of the line.
std::vector<std::string> drawnLines(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char letter : text) {
    if (letter == '\r' || letter == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += letter;
    }
  }
  return lines;
}

// A line that was wider than the terminal broke, and every drawing left another line behind.
TEST_F(Batch, TheBarFitsTheTerminalAndSaysRateAndTimeLeft) {
  if (finish(start("/bin/sh", {"-c", "command -v script"})).exitCode != 0)
    GTEST_SKIP() << "script (bsdutils), which makes a terminal, is not installed";
  writeLibrary();
  for (const std::size_t columns : {80U, 60U, 20U}) {
    SCOPED_TRACE(columns);
    const std::string command = "stty cols " + std::to_string(columns) + "; exec '" + programPath() +
                                "' batch in -o out --force --quality fast --levels 3 --jobs 1";
    const Finished finished = finish(start("/usr/bin/script", {"-qec", command, "/dev/null"}));
    EXPECT_EQ(finished.exitCode, 0) << finished.out;
    std::size_t bars = 0;
    bool left = false;
    for (const std::string& line : drawnLines(finished.out)) {
      if (line.rfind("batch ", 0) != 0) continue;
      ++bars;
      left = left || (line.find("/s, 0") != std::string::npos && line.find(" left") != std::string::npos);
      EXPECT_LT(line.size(), columns) << line;
    }
    EXPECT_GT(bars, 2U) << finished.out;
    EXPECT_EQ(left, columns > 50) << finished.out;
    EXPECT_NE(finished.out.find("3 assets: 3 done"), std::string::npos);
  }
}

TEST_F(Batch, WithoutATerminalEveryAssetIsALine) {
  writeLibrary();
  const Finished finished = batch({"in", "-o", "out"});
  EXPECT_EQ(finished.exitCode, 0);
  const std::string& lines = finished.err;
  EXPECT_EQ(lines.find('\r'), std::string::npos) << lines;
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 3) << lines;
  EXPECT_NE(lines.find("[3/3] "), std::string::npos) << lines;
}

}  // namespace
}  // namespace spheretree::tests
