// SPDX-License-Identifier: MIT
#include "pilot.hpp"

#include <chrono>

namespace crowded_room {

namespace {

constexpr float kLatencyShare = 0.1F;  // of the newest measurement in the running mean

std::int64_t nowMicroseconds() {
  using std::chrono::microseconds;
  return std::chrono::duration_cast<microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void average(float& mean, std::int64_t microseconds) {
  const float milliseconds = static_cast<float>(microseconds) / 1000;
  mean = mean == 0 ? milliseconds : mean + kLatencyShare * (milliseconds - mean);
}

}  // namespace

void Pilot::holdKeys() noexcept {
  const auto pull = [](bool positive, bool negative) {
    return (positive ? 1.0F : 0.0F) - (negative ? 1.0F : 0.0F);
  };
  stick_.hold(Hand::Keyboard,
              {pull(keys_.right, keys_.left), pull(keys_.up, keys_.down), pull(keys_.back, keys_.forward)});
}

void Pilot::releaseKeys() noexcept {
  keys_ = {};
  holdKeys();
}

void Pilot::handle(const SDL_Event& event) {
  gamepad_.handle(event);
  if (event.type != SDL_KEYDOWN && event.type != SDL_KEYUP) return;
  const bool down = event.type == SDL_KEYDOWN;
  switch (event.key.keysym.scancode) {  // by place on the keyboard, whatever is printed on the key
    case SDL_SCANCODE_A:
    case SDL_SCANCODE_LEFT:
      keys_.left = down;
      break;
    case SDL_SCANCODE_D:
    case SDL_SCANCODE_RIGHT:
      keys_.right = down;
      break;
    case SDL_SCANCODE_W:
    case SDL_SCANCODE_UP:
      keys_.forward = down;
      break;
    case SDL_SCANCODE_S:
    case SDL_SCANCODE_DOWN:
      keys_.back = down;
      break;
    case SDL_SCANCODE_E:
    case SDL_SCANCODE_PAGEUP:
      keys_.up = down;
      break;
    case SDL_SCANCODE_Q:
    case SDL_SCANCODE_PAGEDOWN:
      keys_.down = down;
      break;
    default:
      return;
  }
  holdKeys();
}

StickInput Pilot::input(const Camera& camera) {
  stick_.hold(Hand::Joystick, gamepad_.tilt());
  return {camera.toRoom(stick_.tilt()), ++sequence_, nowMicroseconds()};
}

void Pilot::feel(const Room& room, const Camera& camera) {
  const StickInput& consumed = room.consumed().input;
  if (consumed.stampMicroseconds > 0) {
    average(latency_.toSimulation, nowMicroseconds() - consumed.stampMicroseconds);
    consumedStamp_ = consumed.stampMicroseconds;
  }
  if (touch_.feel(room, camera)) gamepad_.force().kick(touch_.kick());
}

StickShown Pilot::shown(const Room& room, const Camera& camera) const noexcept {
  return {stick_.raw(), camera.toStick(room.consumed().input.stick), stick_.hand(), touch_.kick(), latency_,
          touch_.hits()};
}

void Pilot::presented() noexcept {
  if (consumedStamp_ == 0) return;
  average(latency_.toFrame, nowMicroseconds() - consumedStamp_);
  consumedStamp_ = 0;
}

std::optional<std::string> Pilot::news() {
  std::string status = gamepad_.status();
  if (status == said_) return std::nullopt;
  said_ = status;
  return status;
}

}  // namespace crowded_room
