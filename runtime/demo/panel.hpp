// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "history.hpp"
#include "options.hpp"
#include "room.hpp"
#include "stage.hpp"

namespace crowded_room {

/// The controls of the room and what it measures, between Overlay::begin() and end().
class Panel {
 public:
  /// Shows the panel and takes what the user changes. Settings that the room refuses are put back, and its
  /// reason is shown.
  void draw(Room& room, StageSettings& stage, Viewpoint& view, const History& history,
            const std::string& devices);

  /// Shows without taking anything, for pictures.
  void draw(const Room& room, const StageSettings& stage, Viewpoint view, const History& history,
            const std::string& devices);

 private:
  struct Wishes;
  void drawAll(Wishes& wishes, const Room& room, const History& history, const std::string& devices);

  std::string refused_;
};

}  // namespace crowded_room
