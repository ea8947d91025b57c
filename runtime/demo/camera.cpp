// SPDX-License-Identifier: MIT
#include "camera.hpp"

#include <algorithm>
#include <cmath>

namespace crowded_room {

using spheretree::Vec3;

namespace {

constexpr float kSteepest = 1.5F;  // radians, a little less than straight down
constexpr float kNearest = 3;      // room units: the avatar fills the picture
constexpr float kFarthest = 220;   // the whole room in view
constexpr DepthRange kDepths{0.3F, 600};

}  // namespace

void Camera::turn(float yaw, float pitch) noexcept {
  setAngles(yaw_ + yaw, pitch_ + pitch);
}

void Camera::setAngles(float yaw, float pitch) noexcept {
  yaw_ = yaw;
  pitch_ = std::clamp(pitch, -kSteepest, kSteepest);
}

void Camera::zoom(float factor) noexcept {
  distance_ = std::clamp(distance_ / factor, kNearest, kFarthest);
}

Vec3 Camera::eye() const noexcept {
  const Vec3 away{std::sin(yaw_) * std::cos(pitch_), std::sin(pitch_), std::cos(yaw_) * std::cos(pitch_)};
  return target_ + distance_ * away;
}

Matrix Camera::view() const noexcept {
  return lookAt(eye(), target_, {0, 1, 0});
}

Matrix Camera::viewProjection(float aspect) const noexcept {
  return perspective(slope_, aspect, kDepths) * view();
}

Vec3 Camera::toRoom(Vec3 stick) const noexcept {
  const float c = std::cos(yaw_);
  const float s = std::sin(yaw_);
  return {c * stick.x + s * stick.z, stick.y, c * stick.z - s * stick.x};
}

Vec3 Camera::toStick(Vec3 room) const noexcept {
  const float c = std::cos(yaw_);
  const float s = std::sin(yaw_);
  return {c * room.x - s * room.z, room.y, c * room.z + s * room.x};
}

}  // namespace crowded_room
