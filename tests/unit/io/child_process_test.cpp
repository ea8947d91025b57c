// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/child_process.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace spheretree::io {
namespace {

using testing::HasSubstr;

ChildEnd endOf(const std::function<std::string()>& work, std::uint64_t memoryBytes = 0) {
  Result<ChildProcess> child = ChildProcess::start(work, memoryBytes);
  EXPECT_TRUE(child.ok());
  return child->finish();
}

TEST(ChildProcess, HandsOverWhatItsWorkReturns) {
  using std::string_literals::operator""s;
  const std::string large(5'000'000, 'x');  // more than any pipe holds
  const ChildEnd end = endOf([&large] { return "one\0two"s + large; });
  EXPECT_TRUE(end.finished);
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(end.bytes, "one\0two"s + large);
  EXPECT_GT(end.peakMemoryBytes, large.size());
}

TEST(ChildProcess, ACrashIsAnAnswer) {
  const ChildEnd end = endOf([]() -> std::string {
    std::signal(SIGSEGV, SIG_DFL);  // sanitizers have a handler of their own
    ::raise(SIGSEGV);
    return "never";
  });
  EXPECT_FALSE(end.finished);
  EXPECT_FALSE(end.threw);
  EXPECT_EQ(end.signal, SIGSEGV);
  EXPECT_EQ(signalName(end.signal), "signal 11 (Segmentation fault)");
}

TEST(ChildProcess, TheLastWordsOfALibraryAreKept) {
  const ChildEnd end = endOf([]() -> std::string {
    std::fputs("something\nassertion x > 0 failed\n", stderr);
    std::abort();
  });
  EXPECT_EQ(end.signal, SIGABRT);
  EXPECT_EQ(end.complaint, "assertion x > 0 failed");
}

TEST(ChildProcess, ALibraryThatEndsTheProcessFinishesNothing) {
  for (const int code : {0, 1}) {
    const ChildEnd end = endOf([code]() -> std::string {
      std::fputs("giving up", stderr);
      std::exit(code);
    });
    EXPECT_FALSE(end.finished);
    EXPECT_FALSE(end.threw);
    EXPECT_EQ(end.signal, 0);
    EXPECT_EQ(end.complaint, "giving up");
  }
}

TEST(ChildProcess, AnExceptionIsAnAnswer) {
  const ChildEnd end = endOf([]() -> std::string { throw std::runtime_error("no balls"); });
  EXPECT_TRUE(end.threw);
  EXPECT_EQ(end.bytes, "no balls");
}

TEST(ChildProcess, MemoryIsBounded) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers reserve more than any bound";
#endif
  constexpr std::uint64_t kBound = std::uint64_t{200} << 20;
  const auto take = [](std::size_t bytes) {
    return [bytes] {
      const std::string room(bytes, 'x');
      return room.substr(0, 1);
    };
  };
  EXPECT_TRUE(endOf(take(kBound / 2), kBound).finished);
  const ChildEnd end = endOf(take(2 * kBound), kBound);
  EXPECT_TRUE(end.threw);
  EXPECT_EQ(end.bytes, "out of memory");
}

TEST(ChildProcess, KilledWhenNobodyWaits) {
  int watch = -1;
  {
    Result<ChildProcess> child = ChildProcess::start(
        []() -> std::string {
          ::pause();
          return {};
        },
        0);
    ASSERT_TRUE(child.ok());
    watch = child->watch();
    pollfd poll{watch, POLLIN, 0};
    EXPECT_EQ(::poll(&poll, 1, 0), 0);  // still running
  }
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);  // no child is left
  EXPECT_EQ(errno, ECHILD);
}

TEST(ChildProcess, ItsEndWakesTheWaiting) {
  Result<ChildProcess> child = ChildProcess::start([] { return std::string("done"); }, 0);
  ASSERT_TRUE(child.ok());
  pollfd poll{child->watch(), POLLIN, 0};
  constexpr int kPatience = 20'000;  // milliseconds
  EXPECT_EQ(::poll(&poll, 1, kPatience), 1);
  EXPECT_EQ(child->finish().bytes, "done");
}

}  // namespace
}  // namespace spheretree::io
