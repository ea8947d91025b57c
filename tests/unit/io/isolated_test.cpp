// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/isolated.hpp"

#include <csignal>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace spheretree::io {
namespace {

constexpr std::chrono::seconds kPlenty(60);

TEST(Isolated, BytesComeHomeWhateverTheyAre) {
  // More than a pipe holds, zeros among them.
  std::string bytes(1'000'003, '\0');
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<char>(k % 251);
  const Result<std::string> result = runIsolated([&] { return Result<std::string>(bytes); }, kPlenty);
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_TRUE(*result == bytes);
  const Result<std::string> nothing = runIsolated([] { return Result<std::string>(std::string()); }, kPlenty);
  ASSERT_TRUE(nothing.ok()) << nothing.error().message;
  EXPECT_EQ(*nothing, "");
}

TEST(Isolated, ErrorsComeHomeWithTheirCode) {
  const Result<std::string> named = runIsolated(
      []() -> Result<std::string> {
        return Error{ErrorCode::UnsuitableMesh, "line 3: no"};
      },
      kPlenty);
  ASSERT_FALSE(named.ok());
  EXPECT_EQ(named.error().code, ErrorCode::UnsuitableMesh);
  EXPECT_EQ(named.error().message, "line 3: no");
  const Result<std::string> thrown =
      runIsolated([]() -> Result<std::string> { throw std::runtime_error("odd"); }, kPlenty);
  ASSERT_FALSE(thrown.ok());
  EXPECT_EQ(thrown.error().code, ErrorCode::UnreadableInput);
  EXPECT_EQ(thrown.error().message, "odd");
  const Result<std::string> crowded =
      runIsolated([]() -> Result<std::string> { throw std::bad_alloc(); }, kPlenty);
  ASSERT_FALSE(crowded.ok());
  EXPECT_EQ(crowded.error().code, ErrorCode::Internal);
}

TEST(Isolated, DeathIsAnErrorAndNotOurs) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE}) {
    const Result<std::string> result = runIsolated(
        [signal]() -> Result<std::string> {
          ::signal(signal, SIG_DFL);
          ::raise(signal);
          return std::string("not reached");
        },
        kPlenty);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::UnreadableInput);
    EXPECT_NE(result.error().message.find("broke down"), std::string::npos) << result.error().message;
  }
  const Result<std::string> ended =
      runIsolated([]() -> Result<std::string> { ::_Exit(EXIT_SUCCESS); }, kPlenty);
  EXPECT_FALSE(ended.ok());
}

TEST(Isolated, WorkWithoutEndIsEnded) {
  const Result<std::string> result = runIsolated(
      []() -> Result<std::string> {
        for (std::atomic<unsigned> k = 0;;) ++k;
      },
      std::chrono::seconds(1));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::UnreadableInput);
  EXPECT_NE(result.error().message.find("end"), std::string::npos) << result.error().message;
}

}  // namespace
}  // namespace spheretree::io
