// SPDX-License-Identifier: MIT
#pragma once

#include <spheretree/vec3.hpp>

#include "matrix.hpp"

namespace crowded_room {

/// An eye that looks at a point from a distance, turned by the mouse.
///
/// The axes of the stick are those of the picture: right is right on the screen, forward is into it.
class Camera {
 public:
  /// Behind and above `target`, at its distance.
  void follow(spheretree::Vec3 target) noexcept { target_ = target; }
  /// Angles in radians; the pitch is kept short of straight up and down.
  void turn(float yaw, float pitch) noexcept;
  /// Divides the distance, within limits.
  void zoom(float factor) noexcept;
  void setDistance(float distance) noexcept { distance_ = distance; }
  void setAngles(float yaw, float pitch) noexcept;
  /// Tangent of half the vertical field of view.
  void setSlope(float slope) noexcept { slope_ = slope; }
  [[nodiscard]] float slope() const noexcept { return slope_; }

  [[nodiscard]] spheretree::Vec3 eye() const noexcept;
  [[nodiscard]] spheretree::Vec3 target() const noexcept { return target_; }
  /// World to eye coordinates.
  [[nodiscard]] Matrix view() const noexcept;
  /// World to clip coordinates.
  [[nodiscard]] Matrix viewProjection(float aspect) const noexcept;

  /// A vector in the frame of the stick (x right, y up, z towards the user) to the axes of the room and back;
  /// the frame turns with the camera about the vertical only.
  [[nodiscard]] spheretree::Vec3 toRoom(spheretree::Vec3 stick) const noexcept;
  [[nodiscard]] spheretree::Vec3 toStick(spheretree::Vec3 room) const noexcept;

 private:
  spheretree::Vec3 target_;
  float distance_ = 18;
  float yaw_ = 0;
  float pitch_ = 0.35F;
  float slope_ = 0.5F;
};

}  // namespace crowded_room
