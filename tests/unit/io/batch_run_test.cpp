// SPDX-License-Identifier: GPL-3.0-or-later
//
// The loop of a batch with builds that only pretend: what it does about crashes, memory and threads.
#include "io/batch_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "test_folder.hpp"

namespace spheretree::io {
namespace {

using testing::HasSubstr;

class BatchRun : public tests::InFolder {
 protected:
  void SetUp() override {
    InFolder::SetUp();
    options_.folder = folder_ / "out";
    std::filesystem::create_directory(options_.folder);
    options_.limits.threads = 2;
  }

  void add(const std::string& name, const std::string& text = "f 1 2 3\n") {
    BatchAsset asset;
    asset.input = put(name + ".obj", text + "# " + name + "\n");
    asset.output = name + ".sph";
    plan_.assets.push_back(asset);
  }

  BatchResult run(const BuildAsset& build) {
    Result<BatchJournal> journal = BatchJournal::open(options_.folder, {});
    EXPECT_TRUE(journal.ok());
    const medial::Context context(1);
    Result<BatchResult> result = runBatch(plan_, options_, build, {}, *journal, context);
    EXPECT_TRUE(result.ok());
    journal->remove();
    return std::move(*result);
  }

  /// A build that says with how many threads it ran.
  static Result<BuiltAsset> pretend(const BatchAsset& asset, unsigned threads) {
    const nlohmann::json report = {{"tree", {{"levels", 1}}}, {"threads", threads}};
    return BuiltAsset{"tree of " + asset.output, report.dump(), {}, {}};
  }

  BatchPlan plan_;
  BatchOptions options_;
};

TEST_F(BatchRun, ACrashOfOneAssetIsASentence) {
  for (const char* name : {"abort", "fine", "segv", "throws", "refuses"}) add(name);
  const BatchResult result = run([](const BatchAsset& asset, unsigned threads) -> Result<BuiltAsset> {
    if (asset.output == "abort.sph") std::abort();
    if (asset.output == "segv.sph") ::raise(SIGSEGV);
    if (asset.output == "throws.sph") throw std::runtime_error("lost");
    if (asset.output == "refuses.sph") return Error{ErrorCode::UnsuitableMesh, "is no solid"};
    return pretend(asset, threads);
  });
  EXPECT_EQ(result.outcomes[0].record.trouble, Trouble::Crashed);
  EXPECT_THAT(result.outcomes[0].record.reason,
              HasSubstr("abort.obj: the build crashed with signal 6 (Aborted)"));
  EXPECT_EQ(result.outcomes[1].record.state, AssetState::Done);
  EXPECT_EQ(contentOf(options_.folder / "fine.sph"), "tree of fine.sph");
  EXPECT_EQ(result.outcomes[2].record.trouble, Trouble::Crashed);
  EXPECT_EQ(result.outcomes[3].record.trouble, Trouble::Internal);
  EXPECT_THAT(result.outcomes[3].record.reason, HasSubstr("throws.obj: unexpected: lost"));
  EXPECT_EQ(result.outcomes[4].record.trouble, Trouble::UnsuitableMesh);
  EXPECT_THAT(result.outcomes[4].record.reason, HasSubstr("refuses.obj: is no solid"));
}

TEST_F(BatchRun, WhatDoesNotFitBesideOthersFitsAlone) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers reserve more than any bound";
#endif
  options_.limits.memoryBytes = std::uint64_t{1} << 30;
  for (const char* name : {"hungry", "modest"}) add(name);
  const BatchResult result = run([](const BatchAsset& asset, unsigned threads) -> Result<BuiltAsset> {
    const std::size_t bytes = asset.output == "hungry.sph" ? std::size_t{700} << 20 : 1;
    const std::string room(bytes, 'x');
    if (room[bytes / 2] != 'x') return Error{};
    return pretend(asset, threads);
  });
  for (const AssetOutcome& outcome : result.outcomes) EXPECT_EQ(outcome.record.state, AssetState::Done);
  EXPECT_GT(result.outcomes[0].cost->peakMemoryBytes, std::uint64_t{700} << 20);
  // With less than that there is no way.
  options_.limits.memoryBytes = std::uint64_t{500} << 20;
  options_.overwrite = Overwrite::Replace;
  EXPECT_EQ(run([](const BatchAsset&, unsigned) -> Result<BuiltAsset> {
              const std::string room(std::size_t{700} << 20, 'x');
              return Error{ErrorCode::Internal, room.substr(0, 1)};
            })
                .outcomes[0]
                .record.trouble,
            Trouble::OutOfMemory);
}

// Needles of twelve triangles take 800 MB; each was built twice, the second time with nothing beside it.
TEST_F(BatchRun, AnEvenShareOfTheMemoryNeedsNoSecondTry) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers reserve more than any bound";
#endif
  options_.limits.memoryBytes = std::uint64_t{1} << 30;
  for (const char* name : {"needle", "other"}) add(name);
  const auto tries = folder_ / "tries";
  const BatchResult result = run([&tries](const BatchAsset& asset, unsigned threads) -> Result<BuiltAsset> {
    std::ofstream(tries, std::ios::app) << 'x';
    const std::string room(std::size_t{400} << 20, 'x');
    if (room[room.size() / 2] != 'x') return Error{};
    return pretend(asset, threads);
  });
  for (const AssetOutcome& outcome : result.outcomes) EXPECT_EQ(outcome.record.state, AssetState::Done);
  EXPECT_EQ(contentOf(tries), "xx");
}

TEST_F(BatchRun, LargeAssetsGetThreadsAndSmallOnesOneEach) {
  std::string large;
  for (int k = 0; k < 70'000; ++k) large += "f 1 2 3\n";
  add("large", large);
  for (int k = 0; k < 8; ++k) add("small" + std::to_string(k));
  options_.limits.threads = 4;
  const BatchResult result = run(pretend);
  EXPECT_EQ(result.outcomes[0].cost->threads, 4U);
  // The last ones may share what is idle by then; the first ones run beside each other.
  EXPECT_EQ(result.outcomes[1].cost->threads, 1U);
  EXPECT_EQ(result.limits.jobs, 4U);
}

TEST_F(BatchRun, TheRecordKeepsNothingOfTheClock) {
  add("box");
  run(pretend);
  const auto record = nlohmann::json::parse(contentOf(options_.folder / "box.report.json"));
  EXPECT_FALSE(record.contains("threads"));
  EXPECT_EQ(record.at("tree").at("file_hash"), contentHash("tree of box.sph"));
  EXPECT_EQ(record.at("batch").at("state"), "done");
}

TEST_F(BatchRun, TwoRunsDoNotMeetInOneFolder) {
  Result<BatchJournal> first = BatchJournal::open(options_.folder, {});
  ASSERT_TRUE(first.ok());
  const Result<BatchJournal> second = BatchJournal::open(options_.folder, {});
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("another batch is writing there"));
  EXPECT_FALSE(BatchJournal::open(options_.folder, Shard{1, 2}).ok());  // a shard is part of the whole
}

TEST_F(BatchRun, ShardsShareAFolderButNotAShard) {
  Result<BatchJournal> first = BatchJournal::open(options_.folder, Shard{1, 2});
  ASSERT_TRUE(first.ok());
  EXPECT_TRUE(BatchJournal::open(options_.folder, Shard{2, 2}).ok());
  EXPECT_FALSE(BatchJournal::open(options_.folder, Shard{1, 2}).ok());
}

TEST_F(BatchRun, AJournalSurvivesItsRunAndATornLine) {
  {
    Result<BatchJournal> journal = BatchJournal::open(options_.folder, {});
    ASSERT_TRUE(journal.ok());
    journal->add("a.sph", {1.5, 1000, 2});
  }
  std::ofstream(options_.folder / ".spheretree-batch", std::ios::app) << R"({"output": "b.s)";
  Result<BatchJournal> again = BatchJournal::open(options_.folder, {});
  ASSERT_TRUE(again.ok());
  ASSERT_EQ(again->costs().size(), 1U);
  EXPECT_EQ(again->costs().at("a.sph").seconds, 1.5);
  again->add("c.sph", {2.5, 1000, 2});
  again->recall({{"a.sph", {9, 9, 9}}, {"d.sph", {3.5, 1, 1}}});
  EXPECT_EQ(again->costs().at("a.sph").seconds, 1.5);  // the journal is newer
  EXPECT_EQ(again->costs().at("d.sph").seconds, 3.5);
}

}  // namespace
}  // namespace spheretree::io
