// SPDX-License-Identifier: MIT
#pragma once

#include <SDL.h>

#include <memory>
#include <string>

#include <spheretree/vec3.hpp>

#include "force_feedback.hpp"

namespace crowded_room {

/// The joystick or game controller in use: the first there is, and the next one when it is pulled.
///
/// One at a time in a program; it opens SDL's joysticks and haptics and closes them.
class Gamepad {
 public:
  Gamepad();
  ~Gamepad();
  Gamepad(const Gamepad&) = delete;
  Gamepad& operator=(const Gamepad&) = delete;

  /// Devices that come and go.
  void handle(const SDL_Event& event);

  [[nodiscard]] bool present() const noexcept { return joystick_ != nullptr; }
  /// The stick as it stands, dead zone included; x right, y up, z towards the user. 0 without a device.
  [[nodiscard]] spheretree::Vec3 tilt() const;
  /// The second stick of a controller, x right, y down; turns the view.
  struct Turn {
    float x = 0;
    float y = 0;
  };
  [[nodiscard]] Turn turn() const;

  [[nodiscard]] ForceFeedback& force() noexcept { return force_; }
  [[nodiscard]] const ForceFeedback& force() const noexcept { return force_; }
  /// One sentence without a full stop: the device and its force feedback, or why there is none.
  [[nodiscard]] std::string status() const;

 private:
  struct Close {
    void operator()(SDL_Joystick* joystick) const noexcept { SDL_JoystickClose(joystick); }
    void operator()(SDL_GameController* controller) const noexcept { SDL_GameControllerClose(controller); }
  };

  void openAny();
  [[nodiscard]] bool open(int index);
  void close() noexcept;

  unsigned opened_ = 0;  // SDL's subsystems
  std::string trouble_;  // why there are no joysticks or haptics at all
  std::string pulled_;   // name of the device that was
  std::unique_ptr<SDL_GameController, Close> controller_;
  std::unique_ptr<SDL_Joystick, Close> owned_;  // of a plain joystick
  SDL_Joystick* joystick_ = nullptr;
  SDL_JoystickID id_ = -1;
  ForceFeedback force_;
};

}  // namespace crowded_room
