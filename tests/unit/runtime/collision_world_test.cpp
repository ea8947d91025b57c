// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/collision_world.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <spheretree/brute_force.hpp>
#include <spheretree/response.hpp>
#include <spheretree/simd.hpp>

#include "heap_calls.hpp"
#include "query_trees.hpp"

namespace spheretree {
namespace {

Pose at(float x, float y = 0, float z = 0) {
  return {{}, {x, y, z}, 1};
}

CollisionWorld makeWorld(const WorldSettings& settings = {}) {
  return CollisionWorld(std::make_unique<BruteForce>(), settings);
}

const float kHalfRoot = std::sqrt(0.5F);
const Rotation kQuarterTurn{0, 0, kHalfRoot, kHalfRoot};
const Rotation kEighthTurn{0, 0, std::sin(0.39269908F), std::cos(0.39269908F)};

class CrowdTest : public testing::Test {
 protected:
  static constexpr Aabb kRoom{{-3, -3, -3}, {3, 3, 3}};

  /// Trees and boxes that move about in a small room.
  CollisionWorld crowd(const WorldSettings& settings, std::size_t count = 150) {
    CollisionWorld world = makeWorld(settings);
    test::Random random(5);
    for (std::size_t i = 0; i < count; ++i) {
      Pose pose = random.pose(3);
      pose.scale = random.uniform(0.2F, 0.6F);
      const Vec3 velocity = random.point(5);
      if (i % 3 == 0) {
        world.addBox({0.5F, 0.7F, 0.3F}, pose, velocity);
      } else {
        world.addTree(i % 2 == 0 ? lattice_ : random_, pose, velocity);
      }
    }
    return world;
  }

  static void run(CollisionWorld& world, int frames) {
    for (int i = 0; i < frames; ++i) {
      ASSERT_TRUE(world.step(1.0F / 60).ok());
      reflectAtWalls(world, kRoom);
      respond(world);
    }
  }

  test::Random seed_{3};
  QueryTree lattice_ = test::queryTreeOf(test::latticeTree(4));
  QueryTree random_ = test::queryTreeOf(test::randomTree(seed_, 4, 9, 8));
};

bool sameContacts(std::span<const Contact> a, std::span<const Contact> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Contact& x, const Contact& y) {
    return x.a == y.a && x.b == y.b && x.point == y.point && x.normal == y.normal && x.depth == y.depth &&
           x.slackBound == y.slackBound && x.level == y.level && x.decided == y.decided;
  });
}

TEST(CollisionWorld, BodiesMoveByTheirVelocity) {
  CollisionWorld world = makeWorld();
  const std::uint32_t body = world.addBox({1, 2, 3}, at(1), {2, 0, -4});
  ASSERT_TRUE(world.step(0.5F).ok());
  EXPECT_EQ(world.pose(body).translation, (Vec3{2, 0, -2}));
  EXPECT_NEAR(world.box(body).min.y, -2, 1e-4F);
  EXPECT_LE(world.box(body).min.y, -2);
  EXPECT_GE(world.box(body).max.x, 3);
}

TEST(CollisionWorld, BoxesFollowRotationAndScale) {
  CollisionWorld world = makeWorld();
  Pose pose = at(0);
  pose.rotation = kQuarterTurn;
  pose.scale = 2;
  const std::uint32_t body = world.addBox({1, 2, 3}, pose);
  EXPECT_NEAR(world.box(body).max.x, 4, 1e-4F);
  EXPECT_NEAR(world.box(body).max.y, 2, 1e-4F);
  EXPECT_NEAR(world.box(body).max.z, 6, 1e-4F);
}

TEST(CollisionWorld, BallsTouchWhereTheyDo) {
  const QueryTree ball =
      test::queryTreeOf(test::treeOf({{{{0, 0, 0}, 1}, kNoParent}}), std::vector<float>{0.125F});
  CollisionWorld world = makeWorld();
  world.addTree(ball, at(0), {1, 0, 0});
  world.addTree(ball, at(3));
  ASSERT_TRUE(world.step(0.5F).ok());
  EXPECT_TRUE(world.contacts().empty());
  ASSERT_TRUE(world.step(1).ok());
  ASSERT_EQ(world.contacts().size(), 1U);
  const Contact& contact = world.contacts()[0];
  EXPECT_EQ(contact.a, 0U);
  EXPECT_EQ(contact.b, 1U);
  EXPECT_NEAR(contact.point.x, 2.25F, 1e-3F);
  EXPECT_NEAR(contact.normal.x, 1, 1e-3F);
  EXPECT_NEAR(contact.depth, 0.5F, 1e-3F);
  EXPECT_NEAR(contact.slackBound, 0.25F, 1e-3F);
  EXPECT_TRUE(contact.decided);
}

TEST(CollisionWorld, BoxesTouchAsTheyAreTurned) {
  CollisionWorld world = makeWorld();
  world.addBox({1, 1, 1}, at(0));
  const std::uint32_t other = world.addBox({1, 1, 1}, at(2.3F));
  ASSERT_TRUE(world.step(0).ok());
  EXPECT_TRUE(world.contacts().empty());
  Pose turned = at(2.3F);
  turned.rotation = kEighthTurn;  // now it reaches 1.414 along x
  world.setPose(other, turned);
  ASSERT_TRUE(world.step(0).ok());
  ASSERT_EQ(world.contacts().size(), 1U);
  EXPECT_NEAR(world.contacts()[0].depth, 0.1142F, 1e-3F);
  EXPECT_NEAR(world.contacts()[0].normal.x, 1, 1e-3F);
  EXPECT_NEAR(world.contacts()[0].point.x, 0.9429F, 1e-3F);
  // Edge against edge: both turned, one about z and one about y; boxes overlap, shapes do not.
  Pose tilted = at(0);
  tilted.rotation = {0, kEighthTurn.z, 0, kEighthTurn.w};
  world.setPose(0, tilted);
  turned.translation = {2.9F, 0, 0};
  world.setPose(other, turned);
  ASSERT_TRUE(world.step(0).ok());
  EXPECT_TRUE(world.contacts().empty());
  turned.translation = {2.8F, 0, 0};
  world.setPose(other, turned);
  ASSERT_TRUE(world.step(0).ok());
  EXPECT_EQ(world.contacts().size(), 1U);
}

TEST(CollisionWorld, BoxesTouchTrees) {
  const QueryTree ball =
      test::queryTreeOf(test::treeOf({{{{0, 0, 0}, 1}, kNoParent}}), std::vector<float>{0.125F});
  CollisionWorld world = makeWorld();
  world.addTree(ball, at(0));
  const std::uint32_t box = world.addBox({1, 1, 1}, at(1.8F, 1.8F));
  ASSERT_TRUE(world.step(0).ok());
  EXPECT_EQ(world.pairs().size(), 1U);
  EXPECT_TRUE(world.contacts().empty());  // the corner is at distance 1.131
  world.setPose(box, at(1.6F, 1.6F));     // now at 0.849
  ASSERT_TRUE(world.step(0).ok());
  ASSERT_EQ(world.contacts().size(), 1U);
  EXPECT_NEAR(world.contacts()[0].depth, 1 - 0.6F * std::sqrt(2.0F), 1e-3F);
  EXPECT_NEAR(world.contacts()[0].normal.x, kHalfRoot, 1e-3F);
  EXPECT_NEAR(world.contacts()[0].slackBound, 0.125F, 1e-3F);
  world.setPose(box, at(0.5F));  // the centre of the ball is inside
  ASSERT_TRUE(world.step(0).ok());
  ASSERT_EQ(world.contacts().size(), 1U);
  EXPECT_NEAR(world.contacts()[0].normal.x, 1, 1e-3F);
  EXPECT_NEAR(world.contacts()[0].depth, 1.5F, 1e-3F);
}

/// How far a ball is from a box that stands upright around the origin.
float gapBetween(const Sphere& ball, Vec3 half) {
  const Vec3 c = ball.center;
  const Vec3 out{std::max(0.0F, std::abs(c.x) - half.x), std::max(0.0F, std::abs(c.y) - half.y),
                 std::max(0.0F, std::abs(c.z) - half.z)};
  return length(out) - ball.radius;
}

/// Whether a chain of balls that all come as close as `gap` to a box goes down from `family`, on `level`, to
/// the last level.
bool chainReaches(const QueryTree& tree, QueryTree::Family family, std::size_t level, const Pose& pose,
                  Vec3 half, float gap) {
  for (std::uint32_t i = 0; i <= family.further; ++i) {
    const std::uint32_t lanes = i == 0 ? family.lanes : tree.lanes(family.block + i);
    for (std::uint32_t lane = 0; lane < kBlockLanes; ++lane) {
      if ((lanes >> lane & 1U) == 0) continue;
      if (gapBetween(transform(pose, tree.ball(family.block + i, lane)), half) > gap) continue;
      if (level + 1 == tree.levelCount()) return true;
      if (chainReaches(tree, tree.family(family.block + i, lane), level + 1, pose, half, gap)) return true;
    }
  }
  return false;
}

TEST(CollisionWorld, BoxesFindTheBallsOfTreesOnEveryPath) {
  const Vec3 half{0.6F, 0.4F, 0.5F};
  test::Random random(11);
  const QueryTree trees[] = {test::queryTreeOf(test::latticeTree(4)),
                             test::queryTreeOf(test::randomTree(random, 4, 20, 6))};
  int hits = 0;
  int misses = 0;
  for (int round = 0; round < 1000; ++round) {
    const QueryTree& tree = trees[round % 2];
    Pose pose = random.pose(1.6F);
    if (round % 3 == 0) pose.rotation = {};
    if (round % 5 == 0) pose.scale = 0.7F;
    bool boxesMeet = false;  // that of a tree holds its surface, not its balls
    const auto find = [&](SimdLevel path) {
      limitSimd(path);
      CollisionWorld world = makeWorld();
      world.addBox(half, at(0));
      world.addTree(tree, pose);
      EXPECT_TRUE(world.step(0).ok());
      boxesMeet = !world.pairs().empty();
      return std::vector<Contact>(world.contacts().begin(), world.contacts().end());
    };
    const std::vector<Contact> contacts = find(SimdLevel::Scalar);
    for (const SimdLevel path : {SimdLevel::Sse2, SimdLevel::Avx2, SimdLevel::Avx512})
      ASSERT_TRUE(sameContacts(contacts, find(path))) << "round " << round;
    constexpr float kDoubt = 1e-4F;  // more than the margin
    const auto reaches = [&](float gap) {
      return gapBetween(transform(pose, tree.root()), half) <= gap &&
             chainReaches(tree, tree.rootFamily(), 1, pose, half, gap);
    };
    if (reaches(-kDoubt) && boxesMeet) {
      ASSERT_EQ(contacts.size(), 1U) << "round " << round;
      EXPECT_EQ(contacts[0].level, tree.levelCount() - 1);
      ++hits;
    } else if (!reaches(kDoubt)) {
      ASSERT_TRUE(contacts.empty()) << "round " << round;
      ++misses;
    }
  }
  limitSimd(supportedSimd());
  EXPECT_GT(hits, 200);
  EXPECT_GT(misses, 200);
}

TEST(CollisionWorld, BroadPhaseAloneAnswersWithBoxes) {
  CollisionWorld world = makeWorld({.narrow = NarrowPhase::Boxes});
  world.addBox({1, 1, 1}, at(0));
  world.addBox({1, 1, 1}, at(0.5F, -1.75F));
  ASSERT_TRUE(world.step(0).ok());
  ASSERT_EQ(world.contacts().size(), 1U);
  EXPECT_EQ(world.contacts()[0].normal, (Vec3{0, -1, 0}));
  EXPECT_NEAR(world.contacts()[0].depth, 0.25F, 1e-4F);
}

TEST(CollisionWorld, NumbersOfRemovedBodiesAreUsedAgain) {
  CollisionWorld world = makeWorld();
  const std::uint32_t first = world.addBox({1, 1, 1}, at(0));
  world.addBox({1, 1, 1}, at(1));
  ASSERT_TRUE(world.step(0).ok());
  EXPECT_EQ(world.contacts().size(), 1U);
  world.remove(first);
  EXPECT_FALSE(world.present(first));
  ASSERT_TRUE(world.step(1).ok());
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_EQ(world.addBox({1, 1, 1}, at(2)), first);
  ASSERT_TRUE(world.step(0).ok());
  EXPECT_EQ(world.contacts().size(), 1U);
}

TEST(CollisionWorld, RefusesPosesThatAreNotFinite) {
  CollisionWorld world = makeWorld();
  world.addBox({1, 1, 1}, at(0));
  world.addBox({1, 1, 1}, at(1), {std::numeric_limits<float>::infinity(), 0, 0});
  const Result<Done> stepped = world.step(1);
  ASSERT_FALSE(stepped.ok());
  EXPECT_EQ(stepped.error().code, ErrorCode::InvalidArgument);
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_TRUE(world.pairs().empty());
}

TEST_F(CrowdTest, AnyNumberOfThreadsFindsTheSameContacts) {
  std::size_t total = 0;
  for (const std::uint32_t perPair : {1U, 5U, 40U}) {
    CollisionWorld one = crowd({.contactsPerPair = perPair});
    CollisionWorld two = crowd({.contactsPerPair = perPair, .threads = 2});
    CollisionWorld many = crowd({.contactsPerPair = perPair, .threads = 5});
    for (int frame = 0; frame < 12; ++frame) {
      run(one, 1);
      run(two, 1);
      run(many, 1);
      ASSERT_GT(one.pairs().size(), 64U);
      ASSERT_TRUE(sameContacts(one.contacts(), two.contacts()));
      ASSERT_TRUE(sameContacts(one.contacts(), many.contacts()));
      total += one.contacts().size();
    }
  }
  EXPECT_GT(total, 1000U);
}

TEST_F(CrowdTest, ContactsAreOrderedAndLimited) {
  CollisionWorld world = crowd({.contactsPerPair = 3});
  run(world, 3);
  std::size_t inARow = 0;
  bool sawThree = false;
  for (std::size_t i = 0; i < world.contacts().size(); ++i) {
    const Contact& contact = world.contacts()[i];
    ASSERT_LT(contact.a, contact.b);
    ASSERT_NEAR(length(contact.normal), 1, 1e-3F);
    ASSERT_GE(contact.depth, 0);
    const bool again =
        i > 0 && world.contacts()[i - 1].a == contact.a && world.contacts()[i - 1].b == contact.b;
    inARow = again ? inARow + 1 : 1;
    ASSERT_LE(inARow, 3U);
    sawThree = sawThree || inARow == 3;
    if (i > 0 && !again) {
      const BodyPair before{world.contacts()[i - 1].a, world.contacts()[i - 1].b};
      ASSERT_LT(before, (BodyPair{contact.a, contact.b}));
    }
  }
  EXPECT_TRUE(sawThree);
}

TEST_F(CrowdTest, ABudgetNeverLosesAContact) {
  CollisionWorld whole = crowd({});
  ASSERT_TRUE(whole.step(0).ok());
  std::size_t undecidedBefore = std::numeric_limits<std::size_t>::max();
  for (const std::uint64_t budget : {1ULL, 2'000ULL, 20'000ULL, 1'000'000ULL}) {
    CollisionWorld limited = crowd({.budget = {.sphereTests = budget}});
    ASSERT_TRUE(limited.step(0).ok());
    std::size_t undecided = 0;
    std::size_t next = 0;
    for (const Contact& contact : limited.contacts()) {
      undecided += contact.decided ? 0U : 1U;
      if (next == whole.contacts().size()) continue;
      const Contact& sure = whole.contacts()[next];
      if (contact.a != sure.a || contact.b != sure.b) continue;
      ASSERT_GE(contact.slackBound, sure.slackBound);
      ++next;
    }
    EXPECT_EQ(next, whole.contacts().size());
    EXPECT_LE(undecided, undecidedBefore);
    undecidedBefore = undecided;
  }
  EXPECT_EQ(undecidedBefore, 0U);
}

TEST_F(CrowdTest, TakesNothingFromTheHeapOnceWarm) {
  for (const WorldSettings& settings :
       {WorldSettings{}, WorldSettings{.contactsPerPair = 8}, WorldSettings{.narrow = NarrowPhase::Boxes},
        WorldSettings{.threads = 3}, WorldSettings{.budget = {.sphereTests = 5000}}}) {
    CollisionWorld world = crowd(settings);
    run(world, 200);
    // The same 200 frames again, from the same start: buffers have met all they can meet.
    const CollisionWorld start = crowd(settings);
    for (std::uint32_t body = 0; body < world.bodyCount(); ++body) {
      world.setPose(body, start.pose(body));
      world.setVelocity(body, start.velocity(body));
    }
    const std::size_t before = test::heapCalls();
    for (int frame = 0; frame < 50; ++frame) {
      const bool stepped = world.step(1.0F / 60).ok();
      reflectAtWalls(world, kRoom);
      respond(world);
      ASSERT_TRUE(stepped);
    }
    EXPECT_EQ(test::heapCalls() - before, 0U);
  }
}

TEST(Response, NegatesTheComponentsOfTheNormal) {
  const VelocityPair straight = negated({{1, 2, 3}, {-1, 0, 0}}, {1, 0, 0});
  EXPECT_EQ(straight.a, (Vec3{-1, 2, 3}));
  EXPECT_EQ(straight.b, (Vec3{1, 0, 0}));
  const VelocityPair diagonal = negated({{1, 1, 1}, {0, 0, 0}}, {kHalfRoot, kHalfRoot, 0});
  EXPECT_EQ(diagonal.a, (Vec3{-1, -1, 1}));
  const VelocityPair parting = negated({{-1, 0, 0}, {1, 0, 0}}, {1, 0, 0});
  EXPECT_EQ(parting.a, (Vec3{-1, 0, 0}));
}

TEST(Response, TurnsBodiesBackThatMeet) {
  CollisionWorld world = makeWorld({.narrow = NarrowPhase::Boxes});
  world.addBox({1, 1, 1}, at(0), {1, 0.5F, 0});
  world.addBox({1, 1, 1}, at(1.9F), {-1, 0, 0});
  ASSERT_TRUE(world.step(0).ok());
  respond(world);
  EXPECT_EQ(world.velocity(0), (Vec3{-1, 0.5F, 0}));
  EXPECT_EQ(world.velocity(1), (Vec3{1, 0, 0}));
  respond(world);  // they part already
  EXPECT_EQ(world.velocity(0), (Vec3{-1, 0.5F, 0}));
}

TEST(Response, WallsSendBodiesBack) {
  CollisionWorld world = makeWorld();
  world.addBox({1, 1, 1}, at(9.5F, -9.5F), {1, 1, 1});
  ASSERT_TRUE(world.step(0).ok());
  reflectAtWalls(world, {{-10, -10, -10}, {10, 10, 10}});
  EXPECT_EQ(world.velocity(0), (Vec3{-1, 1, 1}));
}

}  // namespace
}  // namespace spheretree
