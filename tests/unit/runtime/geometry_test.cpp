// SPDX-License-Identifier: GPL-3.0-or-later
#include <spheretree/aabb.hpp>
#include <spheretree/pose.hpp>
#include <spheretree/sphere.hpp>
#include <spheretree/vec3.hpp>

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace spheretree {
namespace {

constexpr Vec3 kX{1, 0, 0};
constexpr Vec3 kY{0, 1, 0};
constexpr Vec3 kZ{0, 0, 1};

static_assert(dot(Vec3{1, 2, 3}, Vec3{4, -5, 6}) == 12);
static_assert(cross(kX, kY) == kZ && cross(kY, kZ) == kX && cross(kZ, kX) == kY);
static_assert(-Vec3{1, -2, 3} == Vec3{-1, 2, -3});
static_assert(2.0F * Vec3{1, 2, 3} - Vec3{1, 2, 3} * 2.0F == Vec3{});

/// A turn by `angle` radians around a unit axis.
Rotation turn(Vec3 axis, float angle) {
  const Vec3 v = std::sin(angle / 2) * axis;
  return {v.x, v.y, v.z, std::cos(angle / 2)};
}

void expectNear(Vec3 actual, Vec3 expected, float tolerance) {
  EXPECT_LE(length(actual - expected), tolerance)
      << "(" << actual.x << ", " << actual.y << ", " << actual.z << ") instead of (" << expected.x << ", "
      << expected.y << ", " << expected.z << ")";
}

TEST(Vec3, LengthOfAPythagoreanQuadruple) {
  EXPECT_EQ(length({2, 3, 6}), 7);
}

TEST(Sphere, BallsThatTouchOverlap) {
  EXPECT_TRUE(overlap(Sphere{{0, 0, 0}, 1}, Sphere{{3, 0, 0}, 2}));
  EXPECT_FALSE(overlap(Sphere{{0, 0, 0}, 1}, Sphere{{std::nextafter(3.0F, 4.0F), 0, 0}, 2}));
}

TEST(Sphere, ABallInsideAnotherOverlapsIt) {
  EXPECT_TRUE(overlap(Sphere{{0, 0, 0}, 10}, Sphere{{1, 1, 1}, 0.5F}));
  EXPECT_TRUE(overlap(Sphere{{0.5F, 0, 0}, 0}, Sphere{{0.5F, 0, 0}, 0}));
}

TEST(Aabb, BoxesThatShareACornerOverlap) {
  const Aabb unit{{0, 0, 0}, {1, 1, 1}};
  EXPECT_TRUE(overlap(unit, Aabb{{1, 1, 1}, {2, 2, 2}}));
  EXPECT_TRUE(overlap(Aabb{{1, 1, 1}, {2, 2, 2}}, unit));
}

TEST(Aabb, OneSeparatedAxisIsEnough) {
  const Aabb unit{{0, 0, 0}, {1, 1, 1}};
  EXPECT_FALSE(overlap(unit, Aabb{{1.5F, 0, 0}, {2, 1, 1}}));
  EXPECT_FALSE(overlap(unit, Aabb{{0, 1.5F, 0}, {1, 2, 1}}));
  EXPECT_FALSE(overlap(unit, Aabb{{0, 0, -1}, {1, 1, -0.5F}}));
}

TEST(Aabb, BoundsOfABallAreItsCentrePlusMinusItsRadius) {
  EXPECT_EQ(boundsOf({{1, 2, 3}, 0.5F}), (Aabb{{0.5F, 1.5F, 2.5F}, {1.5F, 2.5F, 3.5F}}));
}

TEST(Pose, TheDefaultMovesNothing) {
  EXPECT_EQ(transform(Pose{}, Vec3{1, -2, 3}), (Vec3{1, -2, 3}));
  EXPECT_EQ(transform(Pose{}, Sphere{{1, -2, 3}, 4}), (Sphere{{1, -2, 3}, 4}));
}

TEST(Pose, QuarterTurnsAreRightHanded) {
  constexpr float kQuarter = std::numbers::pi_v<float> / 2;
  expectNear(rotate(turn(kZ, kQuarter), kX), kY, 1e-6F);
  expectNear(rotate(turn(kX, kQuarter), kY), kZ, 1e-6F);
  expectNear(rotate(turn(kY, kQuarter), kZ), kX, 1e-6F);
}

TEST(Pose, AThirdTurnAroundTheDiagonalCyclesTheAxes) {
  constexpr Rotation kThirdTurn{0.5F, 0.5F, 0.5F, 0.5F};
  static_assert(rotate(kThirdTurn, kX) == kY);
  static_assert(rotate(kThirdTurn, kY) == kZ);
  static_assert(rotate(kThirdTurn, kZ) == kX);
}

TEST(Pose, ScalesThenRotatesThenTranslates) {
  const Pose pose{{0.5F, 0.5F, 0.5F, 0.5F}, {10, 20, 30}, 2};
  EXPECT_EQ(transform(pose, kX), (Vec3{10, 22, 30}));
  EXPECT_EQ(transform(pose, Sphere{kX, 3}), (Sphere{{10, 22, 30}, 6}));
}

TEST(Pose, RotationsKeepLengthsAndAngles) {
  constexpr std::uint32_t kSeed = 20240607;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<float> normal;
  const auto vector = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  for (int i = 0; i < 1000; ++i) {
    const Vec3 raw = vector();
    const Rotation q = turn((1 / length(raw)) * raw, 3 * normal(random));
    const Vec3 a = vector();
    const Vec3 b = vector();
    const float scale = length(a) * length(b);
    EXPECT_NEAR(dot(rotate(q, a), rotate(q, b)), dot(a, b), 4e-6F * scale);
    expectNear(rotate(q, cross(a, b)), cross(rotate(q, a), rotate(q, b)), 1e-5F * scale);
  }
}

}  // namespace
}  // namespace spheretree
