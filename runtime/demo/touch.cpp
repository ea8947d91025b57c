// SPDX-License-Identifier: MIT
#include "touch.hpp"

#include <algorithm>

namespace crowded_room {
namespace {

constexpr float kFade = 0.90F;  // per step, of what is drawn

}  // namespace

bool Touch::feel(const Room& room, const Camera& camera) {
  kick_.strength *= kFade;
  const auto slower = [](const Impact& a, const Impact& b) { return a.speed < b.speed; };
  const auto hardest = std::max_element(room.impacts().begin(), room.impacts().end(), slower);
  if (hardest == room.impacts().end()) return false;
  hits_ += room.impacts().size();
  kick_ = {camera.toStick(hardest->normal), kickStrength(hardest->speed)};
  return true;
}

}  // namespace crowded_room
