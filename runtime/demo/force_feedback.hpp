// SPDX-License-Identifier: MIT
#pragma once

#include <SDL.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string_view>

#include <spheretree/vec3.hpp>

namespace crowded_room {

/// A push that the hand on the stick should feel.
struct Kick {
  spheretree::Vec3 push;  ///< unit; where the avatar is pushed: x right, y up, z towards the user
  float strength = 0;     ///< 0 to 1
};

/// What a device can do, best first.
enum class ForceKind : std::uint8_t {
  Constant,  ///< a push in a direction
  Periodic,  ///< a shake along a direction
  Rumble,    ///< motors without a direction
  None
};

[[nodiscard]] std::string_view nameOf(ForceKind kind) noexcept;

/// The effect of SDL for a kick; `kind` is Constant or Periodic. A kick straight up or down has no direction
/// in the plane of a stick; it comes from the user's side.
[[nodiscard]] SDL_HapticEffect effectOf(const Kick& kick, ForceKind kind) noexcept;

/// The kick of a collision at that speed, units per second.
[[nodiscard]] float kickStrength(float impactSpeed) noexcept;

/// Lets one joystick kick. What fails is not tried again; the next best way takes over.
class ForceFeedback {
 public:
  ForceFeedback() = default;
  /// The joystick must stay open for as long as this lives.
  explicit ForceFeedback(SDL_Joystick* joystick);

  /// Passes over kicks that come so soon after a stronger one that they would only weaken it.
  void kick(const Kick& kick);

  [[nodiscard]] ForceKind kind() const noexcept { return kind_; }
  /// Kicks that the device has taken.
  [[nodiscard]] std::uint64_t kicks() const noexcept { return kicks_; }

 private:
  struct CloseHaptic {
    void operator()(SDL_Haptic* haptic) const noexcept { SDL_HapticClose(haptic); }
  };

  void openHaptic();
  void fallBack() noexcept;
  [[nodiscard]] bool run(const Kick& kick);

  SDL_Joystick* joystick_ = nullptr;
  std::unique_ptr<SDL_Haptic, CloseHaptic> haptic_;
  int effect_ = -1;
  ForceKind kind_ = ForceKind::None;
  std::uint64_t kicks_ = 0;
  std::chrono::steady_clock::time_point last_{};
  float lastStrength_ = 0;
};

}  // namespace crowded_room
