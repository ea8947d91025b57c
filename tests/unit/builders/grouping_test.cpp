// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/grouping.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builders/capacity_assignment.hpp"
#include "medial/random.hpp"
#include "tests/unit/builders/solids.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using Choices = std::vector<std::vector<Choice>>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The least cost of all assignments of the items from `item` on; infinite when there is none.
double bruteForce(const Choices& choices, std::vector<std::size_t>& room, std::size_t item = 0) {
  if (item == choices.size()) return 0;
  double best = kInfinity;
  for (const Choice& choice : choices[item]) {
    if (room[choice.place] == 0) continue;
    --room[choice.place];
    best = std::min(best, choice.cost + bruteForce(choices, room, item + 1));
    ++room[choice.place];
  }
  return best;
}

Choices randomChoices(medial::Random& random, std::size_t items, std::uint32_t places) {
  Choices choices(items);
  for (std::vector<Choice>& list : choices) {
    for (std::uint32_t place = 0; place < places; ++place) {
      if (random.uniform() < 0.3) continue;
      // Whole costs make ties, high powers make costs that differ by many orders of magnitude.
      const double cost = random.uniform();
      list.push_back({place, random.next() % 2 == 0 ? std::floor(4 * cost) : std::pow(2 * cost, 8)});
    }
  }
  return choices;
}

TEST(CapacityAssignment, IsTheCheapestOfAll) {
  constexpr std::uint64_t kSeed = 7;
  medial::Random random(kSeed);
  int feasible = 0;
  constexpr int kInstances = 3000;
  for (int instance = 0; instance < kInstances; ++instance) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", instance " + std::to_string(instance));
    const std::size_t items = 1 + random.next() % 6;
    const auto places = static_cast<std::uint32_t>(1 + random.next() % 4);
    const std::size_t capacity = 1 + random.next() % 3;
    const Choices choices = randomChoices(random, items, places);
    std::vector<std::size_t> room(places, capacity);
    const double least = bruteForce(choices, room);

    const auto assigned = assignWithinCapacity(choices, places, capacity);
    ASSERT_EQ(assigned.has_value(), least < kInfinity);
    if (!assigned) continue;
    ++feasible;
    ASSERT_EQ(assigned->size(), items);
    double sum = 0;
    for (std::size_t item = 0; item < items; ++item) {
      const auto own = std::find_if(choices[item].begin(), choices[item].end(),
                                    [&](const Choice& choice) { return choice.place == (*assigned)[item]; });
      ASSERT_NE(own, choices[item].end()) << "not one of its places";
      sum += own->cost;
      ASSERT_GT(room[own->place], 0U) << "too many";
      --room[own->place];
    }
    EXPECT_NEAR(sum, least, 1e-9 * std::max(1.0, least));
  }
  // Both kinds were seen.
  EXPECT_GT(feasible, kInstances / 4);
  EXPECT_LT(feasible, kInstances * 9 / 10);
}

TEST(CapacityAssignment, NothingWhenPlacesDoNotSuffice) {
  const Choices three(3, {{0, 1.0}, {1, 2.0}});
  EXPECT_FALSE(assignWithinCapacity(three, 2, 1).has_value());
  EXPECT_TRUE(assignWithinCapacity(three, 2, 2).has_value());
  EXPECT_FALSE(assignWithinCapacity(three, 2, 0).has_value());
  // One that may go nowhere.
  EXPECT_FALSE(assignWithinCapacity(Choices{{{0, 1.0}}, {}}, 1, 2).has_value());
  // Nobody needs nothing.
  const auto none = assignWithinCapacity(Choices{}, 0, 0);
  ASSERT_TRUE(none.has_value());
  EXPECT_TRUE(none->empty());
}

TEST(CapacityAssignment, MovesOthersAlongAChain) {
  // Item i likes place i and may move on to place i + 1; the last one comes for place 0 and nothing else.
  constexpr std::uint32_t kPlaces = 50;
  Choices choices;
  for (std::uint32_t i = 0; i + 1 < kPlaces; ++i) choices.push_back({{i, 0.0}, {i + 1, 1.0}});
  choices.push_back({{0, 0.0}});
  const auto assigned = assignWithinCapacity(choices, kPlaces, 1);
  ASSERT_TRUE(assigned.has_value());
  for (std::uint32_t i = 0; i + 1 < kPlaces; ++i) EXPECT_EQ((*assigned)[i], i + 1);
  EXPECT_EQ(assigned->back(), 0U);
}

std::vector<Vector3d> row(std::size_t count) {
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) points.emplace_back(static_cast<double>(i), 0, 0);
  return points;
}

TEST(FarApart, HalvesARow) {
  EXPECT_EQ(farApart(row(9), 0, 5), (std::vector<std::size_t>{0, 8, 4, 2, 6}));
  EXPECT_EQ(farApart(row(9), 4, 3), (std::vector<std::size_t>{4, 0, 8}));
}

TEST(FarApart, TakesEveryMemberOnceWhenAllAreWanted) {
  for (const std::size_t wanted : {6U, 7U, 100U}) {
    std::vector<std::size_t> chosen = farApart(row(6), 3, wanted);
    ASSERT_EQ(chosen.size(), 6U);
    EXPECT_EQ(chosen.front(), 3U);
    std::sort(chosen.begin(), chosen.end());
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(chosen[i], i);
  }
  EXPECT_TRUE(farApart({}, 0, 3).empty());
  EXPECT_TRUE(farApart(row(6), 3, 0).empty());
}

/// How far the farthest member is from the chosen ones.
double radiusOf(const std::vector<Vector3d>& members, const std::vector<std::size_t>& chosen) {
  double radius = 0;
  for (const Vector3d& p : members) {
    double nearest = kInfinity;
    for (const std::size_t c : chosen) nearest = std::min(nearest, (p - members[c]).norm());
    radius = std::max(radius, nearest);
  }
  return radius;
}

TEST(FarApart, IsAtMostTwiceTheBest) {
  constexpr std::uint64_t kSeed = 11;
  medial::Random random(kSeed);
  for (int instance = 0; instance < 100; ++instance) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", instance " + std::to_string(instance));
    std::vector<Vector3d> members;
    for (int i = 0; i < 10; ++i)
      members.push_back(randomIn(random, boxAt(Vector3d::Zero(), Vector3d::Ones())));
    double best = kInfinity;
    for (std::size_t a = 0; a < members.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        for (std::size_t c = 0; c < b; ++c) best = std::min(best, radiusOf(members, {a, b, c}));
      }
    }
    EXPECT_LE(radiusOf(members, farApart(members, random.next() % members.size(), 3)), 2 * best);
  }
}

/// Twelve slices of a bar, half a unit inside it, a unit apart.
class GroupEvenly : public testing::Test {
 protected:
  static constexpr std::size_t kSlices = 12;
  static constexpr double kHalf = 0.4;  // of the side of a slice
  static constexpr FitEffort kEffort{32, 1e-4};

  GroupEvenly() {
    for (std::size_t i = 0; i < kSlices; ++i) {
      PointBlock slice;
      for (const double y : {-kHalf, kHalf}) {
        for (const double z : {-kHalf, kHalf}) slice.push({placeOf(i).x(), y, z});
      }
      slices_.push_back(slice);
      middles_.push_back(placeOf(i));
    }
  }

  static Vector3d placeOf(std::size_t slice) {
    return {static_cast<double>(slice) - (kSlices - 1) / 2.0, 0, 0};
  }

  [[nodiscard]] std::vector<DepthProbe> centersAt(const std::vector<std::size_t>& slices) const {
    std::vector<DepthProbe> centers;
    for (const std::size_t s : slices) centers.push_back(probeDepth(bar_, middles_[s]));
    return centers;
  }

  [[nodiscard]] std::vector<Group> group(const std::vector<std::size_t>& starts, std::size_t capacity,
                                         unsigned threads = 1) const {
    const medial::Context context(threads);
    return groupEvenly(bar_, slices_, centersAt(starts), capacity, kEffort, context);
  }

  /// Every slice in one group, held by its ball; nobody has too many.
  void expectSound(const std::vector<Group>& groups, std::size_t capacity) const {
    std::vector<int> times(kSlices, 0);
    for (const Group& group : groups) {
      EXPECT_FALSE(group.members.empty());
      EXPECT_LE(group.members.size(), capacity);
      EXPECT_TRUE(std::is_sorted(group.members.begin(), group.members.end()));
      for (const std::uint32_t m : group.members) {
        ++times[m];
        const double reach = std::sqrt(farthestSquared(slices_[m], group.fit.center.at));
        EXPECT_LE(reach, group.fit.reach * (1 + 1e-12));
      }
    }
    EXPECT_EQ(times, std::vector<int>(kSlices, 1));
  }

  medial::Surface bar_ = boxSurface(12, 1, 1);
  std::vector<PointBlock> slices_;
  std::vector<Vector3d> middles_;
};

TEST_F(GroupEvenly, CutsARowIntoEvenRuns) {
  const std::vector<Group> groups = group(farApart(middles_, 0, 3), 4);
  ASSERT_EQ(groups.size(), 3U);
  expectSound(groups, 4);
  // Three units long, and half a unit deep in the middle.
  const double best = std::sqrt(1.5 * 1.5 + 2 * kHalf * kHalf) - 0.5;
  for (const Group& group : groups) {
    EXPECT_EQ(group.members.size(), 4U);
    EXPECT_EQ(group.members.back() - group.members.front(), 3U) << "not neighbours";
    EXPECT_NEAR(group.fit.standOff(), best, 0.01 * best);
  }
}

TEST_F(GroupEvenly, KeepsTheCapacityWhereverItStarts) {
  for (const std::size_t capacity : {4U, 5U, 7U, 12U}) {
    for (const std::vector<std::size_t>& starts :
         {std::vector<std::size_t>{0, 1, 2}, {11, 0, 10}, {5, 5, 5}, {0, 3, 6, 9, 11}}) {
      expectSound(group(starts, capacity), capacity);
    }
  }
}

TEST_F(GroupEvenly, LeavesOutWhatNobodyChooses) {
  // One ball holds them all; the others would have to come from farther away.
  const std::vector<PointBlock> one{slices_[0]};
  const medial::Context context(1);
  const std::vector<Group> groups = groupEvenly(bar_, one, centersAt({0, 5, 11}), 4, kEffort, context);
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups.front().members, std::vector<std::uint32_t>{0});
  EXPECT_NEAR(groups.front().fit.center.at.x(), placeOf(0).x(), 0.1);
}

TEST_F(GroupEvenly, SameBitsForAnyThreads) {
  const std::vector<Group> first = group({0, 1, 6, 11}, 5, 1);
  const std::vector<Group> second = group({0, 1, 6, 11}, 5, 3);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t g = 0; g < first.size(); ++g) {
    EXPECT_EQ(first[g].members, second[g].members);
    EXPECT_EQ(first[g].fit.center.at, second[g].fit.center.at);
    EXPECT_EQ(first[g].fit.reach, second[g].fit.reach);
  }
}

}  // namespace
}  // namespace spheretree::builders
