// SPDX-License-Identifier: MIT
#pragma once

#include <SDL.h>

#include "image.hpp"

namespace crowded_room {

/// Dear ImGui over the picture: its life, its input, its drawing. One at a time; of one OpenGL context.
class Overlay {
 public:
  /// Without a window there is no input, as in pictures.
  explicit Overlay(SDL_Window* window = nullptr);
  ~Overlay();
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

  /// Whether the panel took the event, so that it means nothing to the room.
  bool handle(const SDL_Event& event);
  /// Begins a frame; until end(), Dear ImGui may be called.
  void begin(PixelSize size);
  /// Draws on the framebuffer that is bound.
  void end();

 private:
  SDL_Window* window_;
};

}  // namespace crowded_room
