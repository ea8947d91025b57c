// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/query_scheduler.hpp>

#include <gtest/gtest.h>

#include "query_trees.hpp"

namespace spheretree {
namespace {

class QuerySchedulerTest : public testing::Test {
 protected:
  static constexpr std::size_t kQueries = 20;

  QuerySchedulerTest() {
    test::Random random(11);
    for (std::size_t i = 0; i < kQueries; ++i) {
      poses_.push_back(random.pose(0.5F));
      queries_.emplace_back(tree_, tree_);
    }
    restart();
  }

  void restart() {
    scheduled_.clear();
    for (std::size_t i = 0; i < kQueries; ++i) {
      queries_[i].restart(poses_[i], Pose{});
      scheduled_.push_back({&queries_[i], static_cast<float>(i)});  // the last matters most
    }
  }

  QueryTree tree_ = test::queryTreeOf(test::latticeTree(4));
  std::vector<Pose> poses_;
  std::vector<PairQuery> queries_;
  std::vector<ScheduledQuery> scheduled_;
  QueryScheduler scheduler_;
};

TEST_F(QuerySchedulerTest, DecidesAllWithoutABudget) {
  EXPECT_EQ(scheduler_.run(scheduled_, {}), 0U);
  for (std::size_t i = 0; i < kQueries; ++i) {
    PairQuery alone(tree_, tree_);
    alone.restart(poses_[i], Pose{});
    EXPECT_EQ(queries_[i].answer(), alone.advance());
    EXPECT_EQ(queries_[i].slackBound(), alone.slackBound());
  }
}

TEST_F(QuerySchedulerTest, TheMostRelevantAreAhead) {
  bool sawLead = false;
  for (std::uint64_t budget = 1; budget < 6000; budget += 100) {
    restart();
    const std::size_t undecided = scheduler_.run(scheduled_, {.sphereTests = budget});
    std::uint64_t tests = 0;
    std::uint32_t before = 0;
    std::uint32_t least = kMaxQueryLevels;
    std::uint32_t most = 0;
    for (std::size_t i = 0; i < kQueries; ++i) {
      tests += queries_[i].sphereTests() - 1;
      if (queries_[i].complete()) continue;
      const std::uint32_t reached = queries_[i].reachedLevel();
      EXPECT_GE(reached, before);  // in the order of relevance
      before = reached;
      least = std::min(least, reached);
      most = std::max(most, reached);
    }
    EXPECT_LE(tests, budget + 64);
    if (least <= most) {
      EXPECT_LE(most - least, 1U);
    }
    sawLead = sawLead || (least < most && undecided > 0);
  }
  EXPECT_TRUE(sawLead);
}

TEST_F(QuerySchedulerTest, NoBudgetNoWork) {
  EXPECT_GT(scheduler_.run(scheduled_, {.sphereTests = 0}), 0U);
  for (const PairQuery& query : queries_) EXPECT_EQ(query.sphereTests(), 1U);
}

TEST_F(QuerySchedulerTest, TimeEndsIt) {
  scheduler_.run(scheduled_, {.microseconds = 0});
  std::size_t begun = 0;
  for (const PairQuery& query : queries_) begun += query.sphereTests() > 1 ? 1U : 0U;
  EXPECT_EQ(begun, 1U);
}

}  // namespace
}  // namespace spheretree
