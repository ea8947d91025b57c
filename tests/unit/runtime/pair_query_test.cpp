// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/pair_query.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include <spheretree/simd.hpp>

#include "query_trees.hpp"

namespace spheretree {
namespace {

constexpr std::uint32_t kEnd = static_cast<std::uint32_t>(kMaxQueryLevels);

Pose at(float x, float y = 0, float z = 0) {
  return {{}, {x, y, z}, 1};
}

Answer ask(const QueryTree& a, const Pose& poseA, const QueryTree& b, const Pose& poseB,
           std::uint32_t level = kEnd) {
  PairQuery query(a, b);
  query.restart(poseA, poseB);
  return query.advance({.deepestLevel = level});
}

/// Two balls of radius 1/2 at x = -1 and 1 under a ball of radius 2.
SphereTree dumbbell() {
  return test::treeOf({{{{0, 0, 0}, 2}, kNoParent}, {{{-1, 0, 0}, 0.5F}, 0}, {{{1, 0, 0}, 0.5F}, 0}});
}

struct Ends {
  std::size_t certain = 0;   // pairs of the last level that overlap by more than rounding, as do all above
  std::size_t possible = 0;  // that overlap but for rounding
};

/// What the walk should find, by recursion in double.
void count(const SphereTree& a, const Node& nodeA, const Pose& poseA, const SphereTree& b, const Node& nodeB,
           const Pose& poseB, std::uint32_t levelsLeft, bool certain, Ends& ends) {
  const auto placed = [](const Pose& pose, const Sphere& ball) { return transform(pose, ball); };
  const Sphere ballA = placed(poseA, nodeA.ball);
  const Sphere ballB = placed(poseB, nodeB.ball);
  const float gap = length(ballB.center - ballA.center) - ballA.radius - ballB.radius;
  constexpr float kRounding = 2e-4F;
  if (gap > kRounding) return;
  certain = certain && gap < -1e-5F;
  if (levelsLeft == 0) {
    ++ends.possible;
    ends.certain += certain ? 1U : 0U;
    return;
  }
  const std::span<const Node> self[2] = {{&nodeA, 1}, {&nodeB, 1}};
  const std::span<const Node> childrenA = nodeA.childCount > 0 ? a.children(nodeA) : self[0];
  const std::span<const Node> childrenB = nodeB.childCount > 0 ? b.children(nodeB) : self[1];
  for (const Node& childA : childrenA) {
    for (const Node& childB : childrenB)
      count(a, childA, poseA, b, childB, poseB, levelsLeft - 1, certain, ends);
  }
}

std::vector<BallContact> allContacts(PairQuery& query, const QueryLimits& limits = {}) {
  std::vector<BallContact> found;
  std::array<BallContact, 7> some;
  while (!query.complete()) {
    const std::size_t count = query.nextContacts(some, limits);
    found.insert(found.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return found;
}

bool sameBits(const std::vector<BallContact>& a, const std::vector<BallContact>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const auto& x, const auto& y) {
           return std::memcmp(&x, &y, sizeof x) == 0;
         });
}

TEST(PairQuery, TwoBallsTouchAtTheSumOfTheirRadii) {
  const QueryTree a = test::queryTreeOf(test::treeOf({{{{0, 0, 0}, 1}, kNoParent}}));
  const QueryTree b = test::queryTreeOf(test::treeOf({{{{0, 0, 0}, 0.5F}, kNoParent}}));
  EXPECT_EQ(ask(a, at(1.49F), b, at(0)), Answer::Overlapping);
  EXPECT_EQ(ask(a, at(1.5F), b, at(0)), Answer::Overlapping);
  EXPECT_EQ(ask(a, at(1.501F), b, at(0)), Answer::Disjoint);
  EXPECT_EQ(ask(a, at(1000), b, at(1001.49F)), Answer::Overlapping);
}

TEST(PairQuery, ChildrenSeparateWhatTheRootsDoNot) {
  const QueryTree tree = test::queryTreeOf(dumbbell());
  EXPECT_EQ(ask(tree, at(0, 1.5F), tree, at(0), 0), Answer::Overlapping);
  EXPECT_EQ(ask(tree, at(0, 1.5F), tree, at(0), 1), Answer::Disjoint);
  EXPECT_EQ(ask(tree, at(1), tree, at(0)), Answer::Overlapping);  // -1 + 1 = 0 touches -1 and 1 at distance 1
  EXPECT_EQ(ask(tree, at(2.5F, 0.9F), tree, at(0)), Answer::Disjoint);
}

TEST(PairQuery, PosesTurnAndScale) {
  const QueryTree bar = test::queryTreeOf(dumbbell());
  const float half = std::sqrt(0.5F);
  const Pose upright{{0, 0, half, half}, {0, 0, 0}, 1};  // the balls at y = -1 and 1
  EXPECT_EQ(ask(bar, upright, bar, at(0)), Answer::Disjoint);
  EXPECT_EQ(ask(bar, upright, bar, at(1, 1)), Answer::Overlapping);
  EXPECT_EQ(ask(bar, upright, bar, upright), Answer::Overlapping);
  Pose large = upright;
  large.scale = 3;  // radii 1.5 at y = -3 and 3
  EXPECT_EQ(ask(bar, large, bar, at(0)), Answer::Disjoint);
  EXPECT_EQ(ask(bar, large, bar, at(0, 1.5F)), Answer::Overlapping);
  EXPECT_EQ(ask(bar, at(0, 1.5F), bar, large), Answer::Overlapping);
  EXPECT_EQ(ask(bar, at(0, 0.5F), bar, large), Answer::Disjoint);
  Pose doubled = upright;
  doubled.rotation = {0, 0, 2, 2};  // length does not matter
  EXPECT_EQ(ask(bar, doubled, bar, at(1, 1)), Answer::Overlapping);
}

TEST(PairQuery, SlackIsTheSumOfTheStandOffs) {
  const QueryTree tree = test::queryTreeOf(dumbbell(), std::vector<float>{1, 0.25F});
  PairQuery query(tree, tree);
  Pose large = at(1);
  large.scale = 2;
  query.restart(large, at(0));
  EXPECT_NEAR(query.slackBound(), 3, 1e-3F);
  EXPECT_GE(query.slackBound(), 3);
  EXPECT_EQ(query.advance(), Answer::Overlapping);
  EXPECT_NEAR(query.slackBound(), 0.75F, 1e-3F);
  EXPECT_GE(query.slackBound(), 0.75F);
  query.restart(at(50), at(0));
  EXPECT_EQ(query.answer(), Answer::Disjoint);
  EXPECT_EQ(query.slackBound(), 0);
}

TEST(PairQuery, SlackNeverMixesLevels) {
  // A sticks out less on level 0, B on level 1: neither level as a whole allows 0.1 + 0.1.
  const QueryTree a = test::queryTreeOf(dumbbell(), std::vector<float>{0.1F, 1});
  const QueryTree b = test::queryTreeOf(dumbbell(), std::vector<float>{2, 0.1F});
  PairQuery query(a, b);
  query.restart(at(0), at(0));
  EXPECT_NEAR(query.slackBound(), 2.1F, 1e-3F);
  ASSERT_EQ(query.advance(), Answer::Overlapping);
  EXPECT_NEAR(query.slackBound(), 1.1F, 1e-3F);
  // A finer level that sticks out farther on both sides makes nothing vaguer.
  PairQuery coarse(a, a);
  coarse.restart(at(0), at(0));
  ASSERT_EQ(coarse.advance(), Answer::Overlapping);
  EXPECT_NEAR(coarse.slackBound(), 0.2F, 1e-3F);
}

TEST(PairQuery, ContactLiesBetweenTheBalls) {
  const QueryTree ball = test::queryTreeOf(test::treeOf({{{{0, 0, 0}, 1}, kNoParent}}));
  PairQuery query(ball, ball);
  query.restart(at(10), at(10, 1.5F));
  ASSERT_EQ(query.advance(), Answer::Overlapping);
  const BallContact contact = query.contact();
  EXPECT_NEAR(contact.point.x, 10, 1e-4F);
  EXPECT_NEAR(contact.point.y, 0.75F, 1e-4F);
  EXPECT_NEAR(contact.normal.y, 1, 1e-4F);
  EXPECT_NEAR(contact.depth, 0.5F, 1e-4F);
  EXPECT_NEAR(contact.ballA.center.x, 10, 1e-4F);
  EXPECT_NEAR(contact.ballA.radius, 1, 1e-4F);
  // The same pair seen from a turned frame of twice the size.
  Pose turned = at(10, 1.5F);
  turned.rotation = {0.5F, 0.5F, 0.5F, 0.5F};
  query.restart(at(10), turned);
  ASSERT_EQ(query.advance(), Answer::Overlapping);
  EXPECT_NEAR(query.contact().normal.y, 1, 1e-4F);
  EXPECT_NEAR(query.contact().point.y, 0.75F, 1e-4F);
}

TEST(PairQuery, EqualCentresHaveANormal) {
  const QueryTree ball = test::queryTreeOf(test::treeOf({{{{0, 0, 0}, 1}, kNoParent}}));
  PairQuery query(ball, ball);
  query.restart(at(0), at(0));
  ASSERT_EQ(query.advance(), Answer::Overlapping);
  EXPECT_EQ(length(query.contact().normal), 1);
  EXPECT_NEAR(query.contact().depth, 2, 1e-4F);
}

TEST(PairQuery, FindsThePairsThatRecursionFinds) {
  std::size_t total = 0;
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const SphereTree a = test::randomTree(random, 1 + random.below(4), 1 + random.below(12), 5);
    const SphereTree b = test::randomTree(random, 1 + random.below(4), 1 + random.below(12), 5);
    const QueryTree laidA = test::queryTreeOf(a);
    const QueryTree laidB = test::queryTreeOf(b);
    Pose poseA = random.pose(1);
    const Pose poseB = random.pose(0.5F);
    poseA.scale = random.uniform(0.5F, 2);
    const auto last = static_cast<std::uint32_t>(std::max(a.levelCount(), b.levelCount()) - 1);
    for (std::uint32_t level = 0; level <= last; ++level) {
      Ends ends;
      count(a, a.root(), poseA, b, b.root(), poseB, level, true, ends);
      PairQuery query(laidA, laidB);
      query.restart(poseA, poseB);
      const std::size_t found = allContacts(query, {.deepestLevel = level}).size();
      EXPECT_GE(found, ends.certain);
      EXPECT_LE(found, ends.possible);
      EXPECT_EQ(query.answer(), found > 0 ? Answer::Overlapping : Answer::Disjoint);
      query.restart(poseA, poseB);
      EXPECT_EQ(query.advance({.deepestLevel = level}), found > 0 ? Answer::Overlapping : Answer::Disjoint);
      total += found;
    }
  }
  EXPECT_GT(total, 1'500U);
}

TEST(PairQuery, AnyBudgetIsRightNeverVaguerAndResumable) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const QueryTree tree = test::queryTreeOf(test::randomTree(random, 4, 10, 6));
    const Pose a = random.pose(0.8F);
    const Pose b = random.pose(0.8F);
    PairQuery whole(tree, tree);
    whole.restart(a, b);
    const Answer truth = whole.advance();
    PairQuery inSteps(tree, tree);
    inSteps.restart(a, b);
    float slack = std::numeric_limits<float>::infinity();
    Answer answer = inSteps.answer();
    std::uint64_t budget = 1;
    for (; answer == Answer::Undecided; ++budget) {
      // From scratch with a budget, and on from the last stop.
      PairQuery fresh(tree, tree);
      fresh.restart(a, b);
      const Answer limited = fresh.advance({.sphereTests = budget});
      ASSERT_TRUE(limited == truth || limited == Answer::Undecided);
      ASSERT_LE(fresh.sphereTests(), budget + 64);
      answer = inSteps.advance({.sphereTests = 1});
      ASSERT_LE(inSteps.slackBound(), slack);
      slack = inSteps.slackBound();
      if (truth == Answer::Overlapping) {
        ASSERT_GE(slack, whole.slackBound());
      }
      std::array<BallContact, 8> waiting;
      if (answer == Answer::Undecided) {
        ASSERT_GT(inSteps.pendingContacts(waiting), 0U);
      }
    }
    EXPECT_EQ(answer, truth);
    EXPECT_EQ(inSteps.sphereTests(), whole.sphereTests());
    EXPECT_EQ(inSteps.slackBound(), whole.slackBound());
    if (truth == Answer::Overlapping) {
      const BallContact x = inSteps.contact();
      const BallContact y = whole.contact();
      EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0);
    }
    const std::vector<BallContact> pieces = allContacts(inSteps, {.sphereTests = 1});
    EXPECT_TRUE(sameBits(pieces, allContacts(whole)));
    EXPECT_EQ(inSteps.pendingContacts({}), 0U);
  }
}

TEST(PairQuery, AnswersKeepWithMoreBudget) {
  std::size_t decided = 0;
  for (std::uint32_t seed = 100; seed < 130; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const QueryTree tree = test::queryTreeOf(test::randomTree(random, 4, 8, 9));
    const Pose a = random.pose(1);
    const Pose b = random.pose(1);
    Answer before = Answer::Undecided;
    float slackBefore = std::numeric_limits<float>::infinity();
    for (std::uint64_t budget = 1; budget < 4000; budget += 40) {
      PairQuery query(tree, tree);
      query.restart(a, b);
      const Answer answer = query.advance({.sphereTests = budget});
      if (before != Answer::Undecided) {
        ASSERT_EQ(answer, before);
      }
      ASSERT_LE(query.slackBound(), slackBefore);
      before = answer;
      slackBefore = query.slackBound();
    }
    decided += before != Answer::Undecided ? 1U : 0U;
  }
  EXPECT_GT(decided, 25U);
}

TEST(PairQuery, NoTimeStillGetsThere) {
  test::Random random(3);
  const QueryTree tree = test::queryTreeOf(test::randomTree(random, 4, 8, 9));
  PairQuery query(tree, tree);
  query.restart(at(0.4F), at(0));
  int calls = 0;
  while (query.advance({.microseconds = 0}) == Answer::Undecided) ASSERT_LT(++calls, 10'000);
  EXPECT_EQ(query.answer(), ask(tree, at(0.4F), tree, at(0)));
}

TEST(PairQuery, DeeperLevelsRefineWhatWasFound) {
  const QueryTree tree = test::queryTreeOf(dumbbell());
  PairQuery query(tree, tree);
  query.restart(at(0, 1.5F), at(0));
  EXPECT_EQ(query.advance({.deepestLevel = 0}), Answer::Overlapping);
  EXPECT_EQ(query.advance({.deepestLevel = 1}), Answer::Disjoint);
  EXPECT_EQ(query.answerAt(0), Answer::Disjoint);
}

TEST(PairQuery, PathsAgreeBitForBit) {
  const SimdLevel best = supportedSimd();
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    const QueryTree a = test::queryTreeOf(test::randomTree(random, 4, 11, 7));
    const QueryTree b = test::queryTreeOf(test::randomTree(random, 3, 8, 7));
    Pose poseA = random.pose(0.7F);
    if (seed % 3 == 0) poseA.rotation = {};
    if (seed % 5 == 0) poseA.scale = random.uniform(0.3F, 3);
    const Pose poseB = seed % 3 == 0 ? at(0.1F) : random.pose(0.7F);
    limitSimd(SimdLevel::Scalar);
    PairQuery query(a, b);
    query.restart(poseA, poseB);
    const std::vector<BallContact> scalar = allContacts(query);
    const std::uint64_t tests = query.sphereTests();
    const float slack = query.slackBound();
    for (std::uint8_t path = 1; path <= static_cast<std::uint8_t>(best); ++path) {
      limitSimd(static_cast<SimdLevel>(path));
      query.restart(poseA, poseB);
      EXPECT_TRUE(sameBits(allContacts(query), scalar));
      EXPECT_EQ(query.sphereTests(), tests);
      EXPECT_EQ(query.slackBound(), slack);
    }
    limitSimd(best);
  }
}

TEST(PairQuery, LengthsBeyondFloatsAreNotCalledDisjoint) {
  const QueryTree tree = test::queryTreeOf(dumbbell());
  PairQuery query(tree, tree);
  for (const float far : {1e30F, std::numeric_limits<float>::infinity(), NAN}) {
    query.restart(at(far), at(0));
    EXPECT_EQ(query.advance(), Answer::Overlapping);
    EXPECT_EQ(query.slackBound(), std::numeric_limits<float>::infinity());
  }
  query.restart(at(1e15F), at(0));
  EXPECT_EQ(query.advance(), Answer::Disjoint);
  Pose small = at(0);
  small.scale = 1e-20F;
  query.restart(small, small);
  EXPECT_EQ(query.advance(), Answer::Overlapping);
}

}  // namespace
}  // namespace spheretree
