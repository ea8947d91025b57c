// SPDX-License-Identifier: MIT
#include "gamepad.hpp"

#include <algorithm>
#include <array>

namespace crowded_room {

using spheretree::Vec3;

namespace {

/// -32768 to 32767 as -1 to 1.
float share(Sint16 value) {
  constexpr float kMost = 32767;
  return std::max(static_cast<float>(value) / kMost, -1.0F);
}

std::string nameOf(SDL_Joystick* joystick) {
  const char* name = SDL_JoystickName(joystick);
  return name != nullptr ? name : "without a name";
}

}  // namespace

Gamepad::Gamepad() {
  for (const unsigned subsystem : {SDL_INIT_JOYSTICK, SDL_INIT_GAMECONTROLLER, SDL_INIT_HAPTIC}) {
    if (SDL_InitSubSystem(subsystem) == 0) {
      opened_ |= subsystem;
    } else if (subsystem != SDL_INIT_HAPTIC) {  // without haptics there is still rumble
      trouble_ = SDL_GetError();
    }
  }
  if ((opened_ & SDL_INIT_JOYSTICK) == 0) return;
  SDL_JoystickEventState(SDL_ENABLE);
  openAny();
}

Gamepad::~Gamepad() {
  close();
  SDL_QuitSubSystem(opened_);
}

void Gamepad::close() noexcept {
  force_ = {};
  controller_.reset();
  owned_.reset();
  joystick_ = nullptr;
  id_ = -1;
}

bool Gamepad::open(int index) {
  if (SDL_IsGameController(index) == SDL_TRUE) {
    controller_.reset(SDL_GameControllerOpen(index));
    joystick_ = controller_ ? SDL_GameControllerGetJoystick(controller_.get()) : nullptr;
  }
  if (joystick_ == nullptr) {
    controller_.reset();
    owned_.reset(SDL_JoystickOpen(index));
    joystick_ = owned_.get();
  }
  if (joystick_ == nullptr) return false;
  id_ = SDL_JoystickInstanceID(joystick_);
  force_ = ForceFeedback(joystick_);
  return true;
}

void Gamepad::openAny() {
  for (int index = 0; index < SDL_NumJoysticks(); ++index) {
    if (open(index)) return;
  }
}

void Gamepad::handle(const SDL_Event& event) {
  if (event.type == SDL_JOYDEVICEADDED && !present()) {
    openAny();
  } else if (event.type == SDL_JOYDEVICEREMOVED && present() && event.jdevice.which == id_) {
    pulled_ = nameOf(joystick_);
    close();
    openAny();
  }
}

Vec3 Gamepad::tilt() const {
  if (controller_) {
    const auto axis = [this](SDL_GameControllerAxis which) {
      return share(SDL_GameControllerGetAxis(controller_.get(), which));
    };
    return {axis(SDL_CONTROLLER_AXIS_LEFTX),
            axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT) - axis(SDL_CONTROLLER_AXIS_TRIGGERLEFT),
            axis(SDL_CONTROLLER_AXIS_LEFTY)};
  }
  if (joystick_ == nullptr) return {};
  // Further axes of a plain joystick may be throttles that rest anywhere: its hat or first buttons rise and
  // sink.
  const Uint8 hat =
      SDL_JoystickNumHats(joystick_) > 0 ? SDL_JoystickGetHat(joystick_, 0) : Uint8{SDL_HAT_CENTERED};
  const bool rise = (hat & SDL_HAT_UP) != 0 || SDL_JoystickGetButton(joystick_, 0) != 0;
  const bool sink = (hat & SDL_HAT_DOWN) != 0 || SDL_JoystickGetButton(joystick_, 1) != 0;
  return {share(SDL_JoystickGetAxis(joystick_, 0)), (rise ? 1.0F : 0.0F) - (sink ? 1.0F : 0.0F),
          share(SDL_JoystickGetAxis(joystick_, 1))};
}

Gamepad::Turn Gamepad::turn() const {
  if (!controller_) return {};
  return {share(SDL_GameControllerGetAxis(controller_.get(), SDL_CONTROLLER_AXIS_RIGHTX)),
          share(SDL_GameControllerGetAxis(controller_.get(), SDL_CONTROLLER_AXIS_RIGHTY))};
}

std::string Gamepad::status() const {
  if (present()) {
    const std::string kind = controller_ ? "controller " : "joystick ";
    return kind + nameOf(joystick_) + ", " + std::string(crowded_room::nameOf(force_.kind()));
  }
  if (!pulled_.empty()) return pulled_ + " was pulled; keyboard and mouse fly on";
  if (!trouble_.empty()) return "no joysticks (" + trouble_ + "); keyboard and mouse fly";
  return "no joystick; keyboard and mouse fly";
}

}  // namespace crowded_room
