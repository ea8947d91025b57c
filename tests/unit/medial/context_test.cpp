// SPDX-License-Identifier: GPL-3.0-or-later
#include "medial/context.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

#include "medial/parallel.hpp"

namespace spheretree::medial {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const unsigned threads : {1U, 2U, 7U}) {
    const Context context(threads);
    std::vector<int> visits(1000, 0);
    parallelFor(visits.size(), context, [&](std::size_t i) { ++visits[i]; });
    EXPECT_EQ(visits, std::vector<int>(1000, 1)) << threads << " threads";
  }
}

TEST(ParallelFor, RethrowsTheFirstFailureByIndex) {
  for (const unsigned threads : {1U, 2U, 7U}) {
    const Context context(threads);
    try {
      parallelFor(100, context, [](std::size_t i) {
        if (i % 10 == 3) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "3") << threads << " threads";
    }
  }
}

TEST(ParallelFor, StopsWhenCancelled) {
  for (const unsigned threads : {1U, 2U}) {
    Context context(threads);
    std::atomic<int> calls{0};
    EXPECT_THROW(parallelFor(100000, context,
                             [&](std::size_t) {
                               if (++calls == 10) context.cancel();
                             }),
                 CancelledError);
    EXPECT_LT(calls.load(), 100);
  }
}

TEST(Context, ReportsProgressWithinBounds) {
  std::vector<double> seen;
  const Context context(1, [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "build");
    seen.push_back(fraction);
  });
  context.report("build", -1);
  context.report("build", 0.5);
  context.report("build", 2);
  EXPECT_EQ(seen, (std::vector<double>{0, 0.5, 1}));
  EXPECT_GE(Context(0).threads(), 1U);
}

}  // namespace
}  // namespace spheretree::medial
