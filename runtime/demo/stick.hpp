// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <spheretree/vec3.hpp>

namespace crowded_room {

/// Who may hold the stick.
enum class Hand : std::uint8_t { Keyboard, Mouse, Joystick };

/// The virtual joystick: what keyboard, mouse and joystick do to it, and where it stands therefore.
///
/// Tilts are -1 to 1 along x (right), y (up) and z (towards the user), of length 1 at most in the plane.
class Stick {
 public:
  /// Tilts of the joystick below this are its resting noise.
  static constexpr float kDeadZone = 0.15F;

  /// How far a hand has tilted it.
  void hold(Hand hand, spheretree::Vec3 tilt) noexcept { held_[static_cast<std::size_t>(hand)] = tilt; }

  /// Of the hand that tilts most, before the dead zone.
  [[nodiscard]] spheretree::Vec3 raw() const noexcept;
  /// What the room is told: raw() without the dead zone of the joystick.
  [[nodiscard]] spheretree::Vec3 tilt() const noexcept;
  /// The hand that tilts most.
  [[nodiscard]] Hand hand() const noexcept;

 private:
  std::array<spheretree::Vec3, 3> held_{};
};

/// Takes away the dead zone: in the plane by the length, so that the direction stays, and of the height. What
/// is beyond it grows from 0, not from a jump; 1 stays 1.
[[nodiscard]] spheretree::Vec3 withoutDeadZone(spheretree::Vec3 raw, float deadZone) noexcept;

/// Milliseconds from an input to what it leads to.
struct Latency {
  float toSimulation = 0;  ///< until the step that moved the avatar by it had been made
  float toFrame = 0;       ///< until the picture of that step was handed to the screen
};

}  // namespace crowded_room
