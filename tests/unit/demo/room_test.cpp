// SPDX-License-Identifier: GPL-3.0-or-later
#include "runtime/demo/room.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/demo/room_library.hpp"

namespace crowded_room {
namespace {

using spheretree::BroadPhaseKind;
using spheretree::NarrowPhase;
using spheretree::Vec3;
using test::library;
using test::makeRoom;

constexpr std::uint32_t kAvatar = 0;

/// As crowded as the room of the paper is with 50,000 objects.
RoomSettings crowded() {
  RoomSettings settings;
  settings.objects = 400;
  settings.size = {20, 10, 10};
  return settings;
}

Vec3 magnitudes(Vec3 v) {
  return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}

std::vector<Vec3> speedsOf(const Room& room) {
  std::vector<Vec3> speeds;
  for (std::uint32_t body = 1; body < room.bodyCount(); ++body)
    speeds.push_back(magnitudes(room.velocity(body)));
  return speeds;
}

std::vector<Vec3> placesOf(const Room& room) {
  std::vector<Vec3> places;
  for (std::uint32_t body = 0; body < room.bodyCount(); ++body) places.push_back(room.place(body));
  return places;
}

void run(Room& room, int steps, Vec3 stick = {}) {
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(room.step({stick}).ok());
}

/// A stick that a restless user holds.
Vec3 restless(int step) {
  const auto at = static_cast<float>(step);
  return {std::sin(0.05F * at), std::sin(0.031F * at), std::cos(0.047F * at)};
}

bool inside(const spheretree::Aabb& box, Vec3 size) {
  return box.min.x >= 0 && box.min.y >= 0 && box.min.z >= 0 && box.max.x <= size.x && box.max.y <= size.y &&
         box.max.z <= size.z;
}

class ModesTest : public testing::TestWithParam<std::tuple<NarrowPhase, Movement, BoxShape>> {
 protected:
  static RoomSettings settings() {
    RoomSettings settings = crowded();
    settings.narrow = std::get<0>(GetParam());
    settings.movement = std::get<1>(GetParam());
    settings.boxShape = std::get<2>(GetParam());
    return settings;
  }
};

TEST_P(ModesTest, EveryVelocityComponentKeepsItsMagnitudeToTheLastBit) {
  Room room = makeRoom(settings());
  const std::vector<Vec3> before = speedsOf(room);
  std::uint64_t contacts = 0;
  for (int step = 0; step < 600; ++step) {
    ASSERT_TRUE(room.step({restless(step)}).ok());
    contacts += room.report().contacts;
  }
  EXPECT_GT(contacts, 1000U);
  EXPECT_EQ(speedsOf(room), before);
  EXPECT_EQ(room.audit().changedSpeeds, 0U);
}

TEST_P(ModesTest, NothingLeavesTheRoom) {
  Room room = makeRoom(settings());
  for (int step = 0; step < 600; ++step) {
    ASSERT_TRUE(room.step({restless(step)}).ok());
    for (std::uint32_t body = 0; body < room.bodyCount(); ++body)
      ASSERT_TRUE(inside(room.box(body), room.settings().size)) << "body " << body << ", step " << step;
  }
  EXPECT_EQ(room.audit().outside, 0U);
}

TEST_P(ModesTest, NoTwoObjectsStick) {
  RoomSettings sparse = settings();
  sparse.objects = 80;
  Room room = makeRoom(sparse);
  std::map<spheretree::BodyPair, int> lasting;
  int longest = 0;
  for (int step = 0; step < 3000; ++step) {
    run(room, 1);
    std::map<spheretree::BodyPair, int> now;
    for (const spheretree::Contact& contact : room.contacts()) {
      const auto before = lasting.find({contact.a, contact.b});
      const int frames = before == lasting.end() ? 1 : before->second + 1;
      now[{contact.a, contact.b}] = frames;
      if (contact.a != kAvatar) longest = std::max(longest, frames);
    }
    lasting = now;
  }
  EXPECT_GT(longest, 0);
  EXPECT_LE(longest, 2 * kFrameRate);
}

INSTANTIATE_TEST_SUITE_P(All, ModesTest,
                         testing::Combine(testing::Values(NarrowPhase::Boxes, NarrowPhase::Shapes),
                                          testing::Values(Movement::SpaceXYZ, Movement::PlaneXZ),
                                          testing::Values(BoxShape::Tree, BoxShape::Exact)));

TEST(RoomTest, TwoObjectsThatStartInEachOtherPart) {
  // In the smallest room every second seed or so puts two of eight objects into each other.
  int together = 0;
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    RoomSettings settings;
    settings.seed = seed;
    settings.objects = 8;
    settings.size = {8, 8, 8};
    Room room = makeRoom(settings);
    run(room, 1);
    std::set<spheretree::BodyPair> pairs;
    for (const spheretree::Contact& contact : room.contacts()) pairs.insert({contact.a, contact.b});
    together += static_cast<int>(pairs.size());
    for (int step = 0; step < 2 * kFrameRate && !pairs.empty(); ++step) {
      run(room, 1);
      std::set<spheretree::BodyPair> still;
      for (const spheretree::Contact& contact : room.contacts()) {
        if (pairs.count({contact.a, contact.b}) != 0) still.insert({contact.a, contact.b});
      }
      pairs = still;
    }
    EXPECT_TRUE(pairs.empty()) << "seed " << seed;
  }
  EXPECT_GT(together, 10);
}

TEST(RoomTest, InThePlaneObjectsKeepTheirHeight) {
  RoomSettings settings = crowded();
  settings.movement = Movement::PlaneXZ;
  Room room = makeRoom(settings);
  std::vector<float> heights;
  for (std::uint32_t body = 1; body < room.bodyCount(); ++body) heights.push_back(room.place(body).y);
  run(room, 300);
  for (std::uint32_t body = 1; body < room.bodyCount(); ++body)
    EXPECT_EQ(room.place(body).y, heights[body - 1]);
}

std::uint64_t hashAfter(const RoomSettings& settings, int steps) {
  Room room = makeRoom(settings);
  for (int step = 0; step < steps; ++step) EXPECT_TRUE(room.step({restless(step)}).ok());
  return room.stateHash();
}

TEST(RoomTest, TheSameStateForAnyBroadPhase) {
  RoomSettings settings = crowded();
  const std::uint64_t expected = hashAfter(settings, 300);
  for (const BroadPhaseKind kind : spheretree::kBroadPhaseKinds) {
    for (const spheretree::GridResolution grid : {spheretree::kPaperGrid, spheretree::GridResolution{}}) {
      settings.broadPhase = kind;
      settings.grid = grid;
      EXPECT_EQ(hashAfter(settings, 300), expected) << spheretree::nameOf(kind);
    }
  }
}

TEST(RoomTest, TheSameStateForAnyNumberOfThreads) {
  RoomSettings settings = crowded();
  settings.objects = 1500;  // enough pairs for several blocks of the narrow phase
  const std::uint64_t expected = hashAfter(settings, 100);
  for (const std::uint32_t threads : {2U, 7U}) {
    settings.threads = threads;
    EXPECT_EQ(hashAfter(settings, 100), expected) << threads << " threads";
  }
}

TEST(RoomTest, SeedAndStickDecideTheState) {
  RoomSettings settings = crowded();
  const std::uint64_t first = hashAfter(settings, 60);
  EXPECT_EQ(hashAfter(settings, 60), first);
  Room resting = makeRoom(settings);
  run(resting, 60);
  EXPECT_NE(resting.stateHash(), first);
  settings.seed = 2;
  EXPECT_NE(hashAfter(settings, 60), first);
}

TEST(RoomTest, ObjectsComeAndGoWhileTheOthersFlyOn) {
  RoomSettings settings = crowded();
  Room room = makeRoom(settings);
  run(room, 50);
  std::vector<Vec3> places = placesOf(room);
  for (const std::uint32_t objects : {2000U, 100U, 0U, 400U}) {
    settings.objects = objects;
    ASSERT_TRUE(room.change(settings).ok());
    ASSERT_EQ(room.bodyCount(), objects + 1);
    const std::size_t kept = std::min<std::size_t>(places.size(), objects + 1);
    for (std::uint32_t body = 0; body < kept; ++body) EXPECT_EQ(room.place(body), places[body]);
    run(room, 20);
    EXPECT_EQ(room.audit().outside, 0U);
    EXPECT_EQ(room.audit().changedSpeeds, 0U);
    places = placesOf(room);
  }
}

TEST(RoomTest, AnotherBroadPhaseInFlightChangesNothing) {
  RoomSettings settings = crowded();
  const std::uint64_t expected = hashAfter(settings, 200);
  Room room = makeRoom(settings);
  for (int step = 0; step < 200; ++step) {
    if (step % 40 == 10) {
      settings.broadPhase = spheretree::kBroadPhaseKinds[static_cast<std::size_t>(step / 40)];
      ASSERT_TRUE(room.change(settings).ok());
    }
    ASSERT_TRUE(room.step({restless(step)}).ok());
  }
  EXPECT_EQ(room.stateHash(), expected);
}

TEST(RoomTest, TheMixDecidesHowManyAreBunnies) {
  RoomSettings settings = crowded();
  Room room = makeRoom(settings);
  for (const float share : {0.0F, 0.25F, 0.5F, 1.0F}) {
    settings.bunnyShare = share;
    ASSERT_TRUE(room.change(settings).ok());
    int bunnies = 0;
    for (std::uint32_t body = 1; body < room.bodyCount(); ++body)
      bunnies += room.kind(body) == ObjectKind::Bunny;
    EXPECT_EQ(static_cast<float>(bunnies), share * 400);
    EXPECT_EQ(room.kind(kAvatar), ObjectKind::Avatar);
    run(room, 20);
    EXPECT_EQ(room.audit().outside, 0U);
  }
}

TEST(RoomTest, FinerLevelsTouchLess) {
  RoomSettings settings = crowded();
  std::vector<std::uint64_t> touching;
  for (const std::uint32_t levels : {1U, 2U}) {
    settings.levels = levels;
    settings.contactsPerPair = 1;
    Room room = makeRoom(settings);
    run(room, 1);
    touching.push_back(room.contacts().size());
  }
  EXPECT_LT(touching[1], touching[0]);
  EXPECT_GT(touching[1], 0U);
}

TEST(RoomTest, ANewSeedStartsAfresh) {
  RoomSettings settings = crowded();
  settings.seed = 9;
  const std::uint64_t expected = makeRoom(settings).stateHash();
  Room room = makeRoom(crowded());
  run(room, 30);
  ASSERT_TRUE(room.change(settings).ok());
  EXPECT_EQ(room.stateHash(), expected);
  EXPECT_EQ(room.stepsMade(), 0U);
}

TEST(RoomTest, SpeedAndMovementChangeInFlight) {
  RoomSettings settings = crowded();
  Room room = makeRoom(settings);
  const std::vector<Vec3> before = speedsOf(room);
  settings.speed = 10;
  ASSERT_TRUE(room.change(settings).ok());
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_FLOAT_EQ(speedsOf(room)[i].x, 2 * before[i].x);
  settings.movement = Movement::PlaneXZ;
  ASSERT_TRUE(room.change(settings).ok());
  for (const Vec3& speed : speedsOf(room)) EXPECT_EQ(speed.y, 0);
  settings.speed = 5;
  settings.movement = Movement::SpaceXYZ;
  ASSERT_TRUE(room.change(settings).ok());
  EXPECT_EQ(speedsOf(room), before);
}

// --- the avatar ---

RoomSettings empty() {
  RoomSettings settings;
  settings.objects = 0;
  return settings;
}

TEST(AvatarTest, FliesWhereTheStickPoints) {
  Room room = makeRoom(empty());
  const Vec3 start = room.place(kAvatar);
  EXPECT_EQ(start, (Vec3{50, 12.5F, 50}));
  run(room, kFrameRate, {1, -0.5F, 0.25F});
  const Vec3 way = room.place(kAvatar) - start;
  EXPECT_NEAR(way.x, Room::kAvatarSpeed, 1e-3F);
  EXPECT_NEAR(way.y, -0.5F * Room::kAvatarSpeed, 1e-3F);
  EXPECT_NEAR(way.z, 0.25F * Room::kAvatarSpeed, 1e-3F);
}

TEST(AvatarTest, StopsAtTheWalls) {
  Room room = makeRoom(empty());
  run(room, 20 * kFrameRate, {1, 1, -1});
  EXPECT_EQ(room.audit().outside, 0U);
  const Vec3 step = room.settings().size - room.place(kAvatar);
  EXPECT_LT(step.x - Room::kAvatarRadius, Room::kAvatarSpeed / kFrameRate);
  EXPECT_EQ(room.velocity(kAvatar), Vec3{});
}

TEST(AvatarTest, TellsWhichInputItConsumed) {
  Room room = makeRoom(empty());
  ASSERT_TRUE(room.step({{0.5F, 0, 0}, 41, 1000}).ok());
  ASSERT_TRUE(room.step({{3, -2, std::numeric_limits<float>::quiet_NaN()}, 42, 2000}).ok());
  EXPECT_EQ(room.consumed().input.sequence, 42U);
  EXPECT_EQ(room.consumed().input.stampMicroseconds, 2000);
  EXPECT_EQ(room.consumed().input.stick, (Vec3{1, -1, 0}));
  EXPECT_EQ(room.consumed().step, 2U);
  EXPECT_EQ(room.stepsMade(), 2U);
}

TEST(AvatarTest, IsHitByWhatItFliesInto) {
  Room room = makeRoom(crowded());
  int hits = 0;
  for (int step = 0; step < 600; ++step) {
    ASSERT_TRUE(room.step({restless(step)}).ok());
    for (const Impact& impact : room.impacts()) {
      ++hits;
      EXPECT_GT(impact.body, kAvatar);
      EXPECT_GT(impact.speed, 0);
      EXPECT_LT(impact.speed, std::sqrt(3.0F) * (Room::kAvatarSpeed + room.settings().speed));
      EXPECT_NEAR(length(impact.normal), 1, 1e-4F);
      EXPECT_LT(length(impact.point - room.place(kAvatar)), Room::kAvatarRadius + 1e-3F);
      // Pushed away from the place of contact.
      EXPECT_GT(dot(impact.normal, room.place(kAvatar) - impact.point), 0);
    }
  }
  EXPECT_GT(hits, 10);
}

TEST(AvatarTest, TurnsAwayWhatHitsIt) {
  Room room = makeRoom(crowded());
  int turned = 0;
  for (int step = 0; step < 600; ++step) {
    std::vector<Vec3> before;
    for (std::uint32_t body = 0; body < room.bodyCount(); ++body) before.push_back(room.velocity(body));
    run(room, 1);
    for (const Impact& impact : room.impacts()) turned += room.velocity(impact.body) != before[impact.body];
  }
  EXPECT_GT(turned, 3);
  EXPECT_EQ(room.place(kAvatar), 0.5F * room.settings().size);  // no one moves it but the user
}

TEST(AvatarTest, DoesNotPassThroughACrowd) {
  // With the stick held it is stopped by what it meets; in the empty room it would be at the wall by then.
  RoomSettings settings = crowded();
  settings.size = {60, 10, 10};
  settings.objects = 1200;
  settings.speed = 0.5F;
  Room room = makeRoom(settings);
  run(room, 2 * kFrameRate, {1, 0, 0});
  EXPECT_LT(room.place(kAvatar).x, 30 + Room::kAvatarSpeed);
}

// --- pause, settings ---

TEST(FlowTest, PausesAndMakesSingleSteps) {
  Room room = makeRoom(crowded());
  room.setFlow(Flow::Paused);
  const std::uint64_t before = room.stateHash();
  EXPECT_FALSE(*room.tick({}));
  EXPECT_EQ(room.stateHash(), before);
  room.askForStep();
  EXPECT_TRUE(*room.tick({}));
  EXPECT_FALSE(*room.tick({}));
  EXPECT_EQ(room.stepsMade(), 1U);
  room.setFlow(Flow::Running);
  EXPECT_TRUE(*room.tick({}));
  EXPECT_EQ(room.stepsMade(), 2U);
}

TEST(SettingsTest, AreRefusedByName) {
  const auto refusal = [](auto spoil) {
    RoomSettings settings = crowded();
    spoil(settings);
    const spheretree::Result<Room> room = Room::create(settings, library());
    return room.ok() ? std::string() : room.error().message;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(refusal([](RoomSettings& s) { s.objects = 2'000'000; }),
            "objects is 2000000; it may be at most 1048576");
  EXPECT_EQ(refusal([](RoomSettings& s) { s.levels = 0; }), "levels is 0; it may be from 1 to 16");
  EXPECT_EQ(refusal([](RoomSettings& s) { s.bunnyTree = "hare"; }),
            "the tree is hare; it may be one of box-built-in, snowman");
  EXPECT_NE(refusal([&](RoomSettings& s) { s.speed = nan; }).find("speed is nan"), std::string::npos);
  EXPECT_NE(refusal([](RoomSettings& s) { s.speed = 1000; }), "");
  EXPECT_NE(refusal([](RoomSettings& s) { s.bunnyShare = 1.5F; }), "");
  EXPECT_NE(refusal([](RoomSettings& s) { s.size.y = 2; }), "");
  EXPECT_NE(refusal([](RoomSettings& s) { s.threads = 0; }), "");
  EXPECT_NE(refusal([](RoomSettings& s) { s.contactsPerPair = 0; }), "");
  EXPECT_NE(refusal([](RoomSettings& s) { s.grid = {1000, 1, 1}; }), "");
}

TEST(SettingsTest, ThatAreRefusedChangeNothing) {
  Room room = makeRoom(crowded());
  const std::uint64_t before = room.stateHash();
  RoomSettings wrong = crowded();
  wrong.objects = 10;
  wrong.speed = -1;
  EXPECT_FALSE(room.change(wrong).ok());
  EXPECT_EQ(room.stateHash(), before);
  EXPECT_EQ(room.settings().objects, 400U);
}

// --- long runs ---

/// SPHERETREE_ROOM_STEPS sets the length; 1,000,000 is the run of docs/experiments.md.
TEST(LongRunTest, AThousandObjectsStayInTheRoomAtTheirSpeeds) {
  const char* const wanted = std::getenv("SPHERETREE_ROOM_STEPS");
  const int steps = wanted != nullptr ? std::atoi(wanted) : 3000;
  Room room = makeRoom({});
  const std::vector<Vec3> before = speedsOf(room);
  for (int step = 0; step < steps; ++step) {
    ASSERT_TRUE(room.step({restless(step)}).ok());
    ASSERT_EQ(room.audit().outside, 0U) << "step " << step;
  }
  EXPECT_EQ(speedsOf(room), before);
}

}  // namespace
}  // namespace crowded_room
