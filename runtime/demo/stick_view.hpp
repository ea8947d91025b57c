// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include <spheretree/vec3.hpp>

#include "force_feedback.hpp"
#include "image.hpp"
#include "stick.hpp"

namespace crowded_room {

/// What there is to see of a stick; all in its own frame.
struct StickShown {
  spheretree::Vec3 raw;       ///< as it is held
  spheretree::Vec3 consumed;  ///< as the last step of the simulation took it
  Hand hand = Hand::Keyboard;
  Kick kick;
  Latency latency;
  std::uint64_t hits = 0;
};

/// Draws the stick in the lower right corner, between Overlay::begin() and end(). Returns where the mouse
/// holds it.
std::optional<spheretree::Vec3> drawStick(const StickShown& shown, PixelSize size);

}  // namespace crowded_room
