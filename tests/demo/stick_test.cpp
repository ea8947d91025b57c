// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "camera.hpp"
#include "stick.hpp"

namespace crowded_room {
namespace {

using spheretree::Vec3;

float plane(Vec3 tilt) {
  return std::hypot(tilt.x, tilt.z);
}

TEST(Stick, RestsInItsDeadZone) {
  Stick stick;
  stick.hold(Hand::Joystick, {0.1F, 0.1F, -0.1F});
  EXPECT_EQ(stick.tilt(), Vec3{});
  EXPECT_EQ(plane(stick.raw()), std::hypot(0.1F, 0.1F)) << "what the hand does is still shown";
}

TEST(Stick, GrowsFromTheEdgeOfTheDeadZoneToFullTilt) {
  EXPECT_NEAR(plane(withoutDeadZone({Stick::kDeadZone + 1e-4F, 0, 0}, Stick::kDeadZone)), 0, 1e-3F);
  EXPECT_NEAR(plane(withoutDeadZone({0, 0, -1}, Stick::kDeadZone)), 1, 1e-6F);
  float last = 0;
  for (float tilt = 0.2F; tilt <= 1; tilt += 0.1F) {
    const float now = plane(withoutDeadZone({tilt, 0, 0}, Stick::kDeadZone));
    EXPECT_GT(now, last);
    last = now;
  }
}

TEST(Stick, KeepsItsDirection) {
  const Vec3 raw{0.3F, 0, -0.4F};
  const Vec3 tilt = withoutDeadZone(raw, Stick::kDeadZone);
  EXPECT_NEAR(std::atan2(tilt.z, tilt.x), std::atan2(raw.z, raw.x), 1e-6F);
}

TEST(Stick, IsNoFasterAcrossTheCorners) {
  Stick stick;
  stick.hold(Hand::Keyboard, {1, 0, -1});
  EXPECT_NEAR(plane(stick.tilt()), 1, 1e-6F);
}

TEST(Stick, FollowsTheHandThatTiltsMost) {
  Stick stick;
  stick.hold(Hand::Keyboard, {-1, 0, 0});
  stick.hold(Hand::Joystick, {0.5F, 0, 0});
  EXPECT_EQ(stick.hand(), Hand::Keyboard);
  EXPECT_EQ(stick.tilt().x, -1);
  stick.hold(Hand::Keyboard, {});
  EXPECT_EQ(stick.hand(), Hand::Joystick);
  EXPECT_GT(stick.tilt().x, 0);
}

TEST(Stick, PointsWhereTheCameraLooks) {
  Camera camera;
  camera.follow({50, 10, 50});
  for (const float yaw : {0.0F, 0.7F, -2.0F}) {
    camera.setAngles(yaw, 0.3F);
    const Vec3 ahead = camera.toRoom({0, 0, -1});
    const Vec3 sight = camera.target() - camera.eye();
    EXPECT_NEAR(ahead.x * sight.z - ahead.z * sight.x, 0, 1e-4F) << "forward is into the picture";
    EXPECT_GT(ahead.x * sight.x + ahead.z * sight.z, 0);
    const Vec3 back = camera.toStick(ahead);
    EXPECT_NEAR(back.z, -1, 1e-6F);
    EXPECT_NEAR(back.x, 0, 1e-6F);
  }
}

}  // namespace
}  // namespace crowded_room
