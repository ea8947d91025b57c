// SPDX-License-Identifier: MIT
//
// SDL's haptic effects are said by where the force comes from, in the plane of the stick: x to the right, y
// towards the user. A kick is a short push that fades; on devices that know no constant force, a short shake.
#include "force_feedback.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace crowded_room {
namespace {

constexpr std::uint16_t kLength = 130;  // ms, long enough to be felt as one push
constexpr std::uint16_t kFade = 90;     // ms of it
constexpr std::uint16_t kPeriod = 40;   // ms, of a shake
constexpr float kWeakest = 0.25F;       // what motors need to move at all
constexpr float kHardestSpeed = 16;     // units per second: the avatar and an object head-on
constexpr float kHighShare = 0.6F;      // of the small, fast motor
constexpr float kFlat = 0.2F;           // a push with less in the plane has no direction there
constexpr float kUnit = 10000;          // SDL takes any multiple of a direction
constexpr auto kPause = std::chrono::milliseconds(60);

template <class T>
T share(float of) {
  return static_cast<T>(std::lround(of * static_cast<float>(std::numeric_limits<T>::max())));
}

}  // namespace

std::string_view nameOf(ForceKind kind) noexcept {
  switch (kind) {
    case ForceKind::Constant:
      return "constant force";
    case ForceKind::Periodic:
      return "periodic force";
    case ForceKind::Rumble:
      return "rumble";
    case ForceKind::None:
      break;
  }
  return "no force feedback";
}

float kickStrength(float impactSpeed) noexcept {
  return kWeakest + (1 - kWeakest) * std::clamp(impactSpeed / kHardestSpeed, 0.0F, 1.0F);
}

SDL_HapticEffect effectOf(const Kick& kick, ForceKind kind) noexcept {
  SDL_HapticDirection from{};
  from.type = SDL_HAPTIC_CARTESIAN;
  const float flat = std::hypot(kick.push.x, kick.push.z);
  if (flat < kFlat) {
    from.dir[1] = static_cast<Sint32>(kUnit);
  } else {
    from.dir[0] = static_cast<Sint32>(std::lround(-kUnit * kick.push.x / flat));
    from.dir[1] = static_cast<Sint32>(std::lround(-kUnit * kick.push.z / flat));
  }
  const auto level = share<Sint16>(std::clamp(kick.strength, 0.0F, 1.0F));
  SDL_HapticEffect effect{};
  if (kind == ForceKind::Constant) {
    effect.constant.type = SDL_HAPTIC_CONSTANT;
    effect.constant.direction = from;
    effect.constant.length = kLength;
    effect.constant.level = level;
    effect.constant.fade_length = kFade;
  } else {
    effect.periodic.type = SDL_HAPTIC_SINE;
    effect.periodic.direction = from;
    effect.periodic.length = kLength;
    effect.periodic.period = kPeriod;
    effect.periodic.magnitude = level;
    effect.periodic.fade_length = kFade;
  }
  return effect;
}

ForceFeedback::ForceFeedback(SDL_Joystick* joystick) : joystick_(joystick) {
  openHaptic();
  if (kind_ == ForceKind::None) fallBack();
}

void ForceFeedback::openHaptic() {
  if (SDL_JoystickIsHaptic(joystick_) != SDL_TRUE) return;
  haptic_.reset(SDL_HapticOpenFromJoystick(joystick_));
  if (!haptic_) return;
  const unsigned can = SDL_HapticQuery(haptic_.get());
  for (const auto& [flag, kind] : {std::pair{SDL_HAPTIC_CONSTANT, ForceKind::Constant},
                                   std::pair{SDL_HAPTIC_SINE, ForceKind::Periodic}}) {
    if ((can & flag) == 0) continue;
    SDL_HapticEffect effect = effectOf({{0, 0, 1}, 1}, kind);
    effect_ = SDL_HapticNewEffect(haptic_.get(), &effect);
    if (effect_ < 0) continue;
    kind_ = kind;
    if ((can & SDL_HAPTIC_GAIN) != 0) SDL_HapticSetGain(haptic_.get(), 100);  // per cent
    return;
  }
  haptic_.reset();
}

void ForceFeedback::fallBack() noexcept {
  haptic_.reset();
  const bool rumbles = kind_ != ForceKind::Rumble && SDL_JoystickHasRumble(joystick_) == SDL_TRUE;
  kind_ = rumbles ? ForceKind::Rumble : ForceKind::None;
}

bool ForceFeedback::run(const Kick& kick) {
  if (kind_ == ForceKind::Rumble) {
    return SDL_JoystickRumble(joystick_, share<Uint16>(kick.strength),
                              share<Uint16>(kHighShare * kick.strength), kLength) == 0;
  }
  SDL_HapticEffect effect = effectOf(kick, kind_);
  return SDL_HapticUpdateEffect(haptic_.get(), effect_, &effect) == 0 &&
         SDL_HapticRunEffect(haptic_.get(), effect_, 1) == 0;
}

void ForceFeedback::kick(const Kick& kick) {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < kPause && kick.strength <= lastStrength_) return;
  while (kind_ != ForceKind::None) {
    if (run(kick)) {
      ++kicks_;
      last_ = now;
      lastStrength_ = kick.strength;
      return;
    }
    fallBack();
  }
}

}  // namespace crowded_room
