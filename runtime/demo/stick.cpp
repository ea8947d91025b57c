// SPDX-License-Identifier: MIT
#include "stick.hpp"

#include <algorithm>
#include <cmath>

namespace crowded_room {

using spheretree::Vec3;

namespace {

/// A number without its share of the dead zone.
float beyond(float size, float deadZone) {
  return std::clamp((size - deadZone) / (1 - deadZone), 0.0F, 1.0F);
}

/// Into the cylinder of radius 1 and height 2.
Vec3 clamped(Vec3 tilt) {
  const float plane = std::hypot(tilt.x, tilt.z);
  const float shrink = plane > 1 ? 1 / plane : 1;
  return {shrink * tilt.x, std::clamp(tilt.y, -1.0F, 1.0F), shrink * tilt.z};
}

}  // namespace

Vec3 withoutDeadZone(Vec3 raw, float deadZone) noexcept {
  const float plane = std::hypot(raw.x, raw.z);
  const float scale = plane > 0 ? beyond(plane, deadZone) / plane : 0;
  return {scale * raw.x, std::copysign(beyond(std::abs(raw.y), deadZone), raw.y), scale * raw.z};
}

Hand Stick::hand() const noexcept {
  const auto farther = [](Vec3 a, Vec3 b) { return dot(a, a) < dot(b, b); };
  const auto most = std::max_element(held_.begin(), held_.end(), farther);
  return static_cast<Hand>(most - held_.begin());
}

Vec3 Stick::raw() const noexcept {
  return clamped(held_[static_cast<std::size_t>(hand())]);
}

Vec3 Stick::tilt() const noexcept {
  return hand() == Hand::Joystick ? withoutDeadZone(raw(), kDeadZone) : raw();
}

}  // namespace crowded_room
