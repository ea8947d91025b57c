// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test_folder.hpp"

namespace spheretree::io {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Files : public tests::InFolder {};

TEST_F(Files, WhatIsWrittenIsRead) {
  using std::string_literals::operator""s;
  std::string bytes = "one\r\n\0two\0"s;
  for (const std::size_t size : {std::size_t{0}, bytes.size(), std::size_t{3'000'001}}) {
    bytes.resize(size, 'x');
    ASSERT_TRUE(writeFileAtomically(in("a"), bytes, Overwrite::Replace).ok());
    const Result<std::string> read = readFile(in("a"));
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read.value(), bytes);
  }
  EXPECT_EQ(filesInFolder(), 1U);
}

TEST_F(Files, UnreadableThingsAreNamed) {
  const Result<std::string> missing = readFile(in("missing"));
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::UnreadableInput);
  EXPECT_EQ(missing.error().message, in("missing").string() + ": No such file or directory");
  const Result<std::string> folder = readFile(folder_);
  ASSERT_FALSE(folder.ok());
  EXPECT_EQ(folder.error().message, folder_.string() + ": is a directory");
}

TEST_F(Files, RefusesToReplaceUnlessTold) {
  ASSERT_TRUE(writeFileAtomically(in("a"), "old", Overwrite::Refuse).ok());
  const Result<Done> second = writeFileAtomically(in("a"), "new", Overwrite::Refuse);
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().code, ErrorCode::UnwritableOutput);
  EXPECT_EQ(second.error().message, in("a").string() + ": exists already");
  EXPECT_EQ(contentOf(in("a")), "old");
  ASSERT_TRUE(writeFileAtomically(in("a"), "new", Overwrite::Replace).ok());
  EXPECT_EQ(contentOf(in("a")), "new");
  EXPECT_EQ(filesInFolder(), 1U);
}

TEST_F(Files, OfManyWritersThatRefuseToReplaceExactlyOneWins) {
  constexpr int kWriters = 8;
  std::vector<int> won(kWriters, 0);
  std::vector<std::thread> threads;
  threads.reserve(kWriters);
  for (int i = 0; i < kWriters; ++i) {
    threads.emplace_back([&, i] {
      const std::string bytes(100'000, static_cast<char>('a' + i));
      won[static_cast<std::size_t>(i)] = writeFileAtomically(in("a"), bytes, Overwrite::Refuse).ok() ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  int winner = -1;
  for (int i = 0; i < kWriters; ++i) {
    if (won[static_cast<std::size_t>(i)] == 0) continue;
    EXPECT_EQ(winner, -1);
    winner = i;
  }
  ASSERT_GE(winner, 0);
  EXPECT_EQ(contentOf(in("a")), std::string(100'000, static_cast<char>('a' + winner)));
  EXPECT_EQ(filesInFolder(), 1U);
}

TEST_F(Files, ReplacingKeepsThePermissionsAndFollowsLinks) {
  put("target", "old");
  ASSERT_EQ(::chmod(in("target").c_str(), 0640), 0);
  std::filesystem::create_symlink("target", in("link"));
  ASSERT_TRUE(writeFileAtomically(in("link"), "new", Overwrite::Replace).ok());
  EXPECT_TRUE(std::filesystem::is_symlink(in("link")));
  EXPECT_EQ(contentOf(in("target")), "new");
  struct stat status {};
  ASSERT_EQ(::stat(in("target").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
}

TEST_F(Files, AFullDeviceIsReported) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full here";
  const Result<Done> written = writeFileAtomically("/dev/full", "bytes", Overwrite::Refuse);
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().message, "/dev/full: No space left on device");
  EXPECT_TRUE(writeFileAtomically("/dev/null", "bytes", Overwrite::Refuse).ok());
}

TEST_F(Files, ALongNameStillFits) {
  const std::string name(255, 'n');
  EXPECT_TRUE(writeFileAtomically(in(name), "x", Overwrite::Refuse).ok());
  EXPECT_FALSE(writeFileAtomically(in(name + "n"), "x", Overwrite::Refuse).ok());
  EXPECT_EQ(filesInFolder(), 1U);
}

struct Target {
  std::string name;
  Overwrite overwrite;
  std::string reason;  ///< empty: fine
};

TEST_F(Files, CheckingSaysWhatWritingWouldSay) {
  put("file", "x");
  std::filesystem::create_directory(in("folder"));
  std::filesystem::create_directory(in("locked"));
  const std::vector<Target> targets = {{"new", Overwrite::Refuse, ""},
                                       {"file", Overwrite::Replace, ""},
                                       {"file", Overwrite::Refuse, "exists already"},
                                       {"folder", Overwrite::Replace, "is a directory"},
                                       {"", Overwrite::Replace, "is not the name of a file"},
                                       {"nowhere/new", Overwrite::Refuse, "No such file or directory"},
                                       {"file/new", Overwrite::Refuse, "is not a folder"}};
  for (const Target& target : targets) {
    SCOPED_TRACE(target.name);
    const Result<Done> checked = checkWritable(in(target.name), target.overwrite);
    EXPECT_EQ(filesInFolder(), 3U) << "checking leaves nothing behind";
    const Result<Done> written = writeFileAtomically(in(target.name), "y", target.overwrite);
    ASSERT_EQ(checked.ok(), target.reason.empty());
    ASSERT_EQ(written.ok(), target.reason.empty());
    if (!written.ok()) {
      EXPECT_EQ(checked.error().message, written.error().message);
      EXPECT_EQ(written.error().code, ErrorCode::UnwritableOutput);
      EXPECT_THAT(written.error().message, StartsWith(in(target.name).string() + ": "));
      EXPECT_THAT(written.error().message, HasSubstr(target.reason));
    }
    std::filesystem::remove(in("new"));
  }
}

TEST_F(Files, ALockedFolderIsReported) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  std::filesystem::permissions(folder_,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_FALSE(checkWritable(in("a"), Overwrite::Refuse).ok());
  EXPECT_FALSE(writeFileAtomically(in("a"), "x", Overwrite::Refuse).ok());
  std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
}

TEST(ContentHash, IsXxh3Of128Bits) {
  // The value that the XXH3 specification gives for no input.
  EXPECT_EQ(contentHash(""), "99aa06d3014798d86001c324468d497f");
  EXPECT_NE(contentHash("a"), contentHash("b"));
  EXPECT_EQ(contentHash("a").size(), 32U);
}

}  // namespace
}  // namespace spheretree::io
