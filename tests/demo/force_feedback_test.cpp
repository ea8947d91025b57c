// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include <gtest/gtest.h>

#include "force_feedback.hpp"

namespace crowded_room {
namespace {

// SDL says where a force comes from: east is +x, the user's side (south) is +y.
TEST(ForceFeedback, APushToTheRightComesFromTheLeft) {
  const SDL_HapticEffect effect = effectOf({{1, 0, 0}, 0.5F}, ForceKind::Constant);
  ASSERT_EQ(effect.type, SDL_HAPTIC_CONSTANT);
  EXPECT_EQ(effect.constant.direction.type, SDL_HAPTIC_CARTESIAN);
  EXPECT_LT(effect.constant.direction.dir[0], 0);
  EXPECT_EQ(effect.constant.direction.dir[1], 0);
}

TEST(ForceFeedback, APushTowardsTheUserComesFromTheFront) {
  const SDL_HapticEffect effect = effectOf({{0, 0, 1}, 0.5F}, ForceKind::Constant);
  EXPECT_EQ(effect.constant.direction.dir[0], 0);
  EXPECT_LT(effect.constant.direction.dir[1], 0);
}

TEST(ForceFeedback, ASlantedPushKeepsItsAngle) {
  const SDL_HapticEffect effect = effectOf({{0.6F, 0, -0.8F}, 1}, ForceKind::Periodic);
  ASSERT_EQ(effect.type, SDL_HAPTIC_SINE);
  const auto x = static_cast<float>(effect.periodic.direction.dir[0]);
  const auto y = static_cast<float>(effect.periodic.direction.dir[1]);
  EXPECT_NEAR(x / std::hypot(x, y), -0.6F, 1e-3F);
  EXPECT_NEAR(y / std::hypot(x, y), 0.8F, 1e-3F);
}

TEST(ForceFeedback, APushFromAboveStillHasADirectionForTheDriver) {
  const SDL_HapticEffect effect = effectOf({{0, 1, 0}, 1}, ForceKind::Constant);
  EXPECT_NE(effect.constant.direction.dir[0] * effect.constant.direction.dir[0] +
                effect.constant.direction.dir[1] * effect.constant.direction.dir[1],
            0);
}

TEST(ForceFeedback, TheLevelIsTheStrength) {
  EXPECT_EQ(effectOf({{1, 0, 0}, 1}, ForceKind::Constant).constant.level, 32767);
  EXPECT_EQ(effectOf({{1, 0, 0}, 0}, ForceKind::Constant).constant.level, 0);
  EXPECT_NEAR(effectOf({{1, 0, 0}, 0.5F}, ForceKind::Periodic).periodic.magnitude, 16384, 1);
}

TEST(ForceFeedback, AHarderHitKicksHarderUpToTheFullForce) {
  EXPECT_GT(kickStrength(0.1F), 0.2F) << "weaker ones do not move a motor";
  EXPECT_GT(kickStrength(8), kickStrength(4));
  EXPECT_LE(kickStrength(1000), 1);
}

TEST(ForceFeedback, WithoutADeviceNothingHappens) {
  ForceFeedback none;
  none.kick({{1, 0, 0}, 1});
  EXPECT_EQ(none.kind(), ForceKind::None);
  EXPECT_EQ(none.kicks(), 0U);
}

}  // namespace
}  // namespace crowded_room
