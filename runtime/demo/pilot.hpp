// SPDX-License-Identifier: MIT
#pragma once

#include <SDL.h>

#include <cstdint>
#include <optional>
#include <string>

#include "camera.hpp"
#include "force_feedback.hpp"
#include "gamepad.hpp"
#include "room.hpp"
#include "stick.hpp"
#include "stick_view.hpp"
#include "touch.hpp"

namespace crowded_room {

/// Sits between the devices and the room: turns what hands do into the stick that the room consumes, and hits
/// of the avatar into kicks.
class Pilot {
 public:
  /// Keys and devices.
  void handle(const SDL_Event& event);
  /// All keys count as released, as when the window loses them.
  void releaseKeys() noexcept;
  /// The mouse on the drawn stick.
  void drag(spheretree::Vec3 tilt) noexcept { stick_.hold(Hand::Mouse, tilt); }

  /// The stick as it stands now, in the axes of the room.
  [[nodiscard]] StickInput input(const Camera& camera);
  /// After each step: kicks for what the avatar met, and when the input got there.
  void feel(const Room& room, const Camera& camera);
  /// After the picture of the last step was handed to the screen.
  void presented() noexcept;

  [[nodiscard]] const Stick& stick() const noexcept { return stick_; }
  [[nodiscard]] const Gamepad& gamepad() const noexcept { return gamepad_; }
  [[nodiscard]] const Latency& latency() const noexcept { return latency_; }
  [[nodiscard]] const Touch& touch() const noexcept { return touch_; }
  /// All there is to see of the stick.
  [[nodiscard]] StickShown shown(const Room& room, const Camera& camera) const noexcept;
  /// Something about the devices that has not been said yet.
  [[nodiscard]] std::optional<std::string> news();

 private:
  void holdKeys() noexcept;

  Gamepad gamepad_;
  Stick stick_;
  struct Keys {
    bool left = false;
    bool right = false;
    bool forward = false;
    bool back = false;
    bool up = false;
    bool down = false;
  } keys_;
  std::uint64_t sequence_ = 0;
  std::int64_t consumedStamp_ = 0;  // of the input of a step whose picture is not shown yet; 0: none
  Latency latency_;
  Touch touch_;
  std::string said_;
};

}  // namespace crowded_room
