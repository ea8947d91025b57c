// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "camera.hpp"
#include "force_feedback.hpp"
#include "room.hpp"

namespace crowded_room {

/// What the hand on the stick feels of the avatar's collisions.
class Touch {
 public:
  /// Once after each step. True when there was a hit; kick() is then that of the hardest one.
  bool feel(const Room& room, const Camera& camera);

  /// The last kick in the frame of the stick, its strength fading since.
  [[nodiscard]] const Kick& kick() const noexcept { return kick_; }
  /// Hits so far, whether or not there was a device to kick.
  [[nodiscard]] std::uint64_t hits() const noexcept { return hits_; }

 private:
  Kick kick_;
  std::uint64_t hits_ = 0;
};

}  // namespace crowded_room
