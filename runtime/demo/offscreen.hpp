// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include <spheretree/result.hpp>

namespace crowded_room {

/// An OpenGL 3.3 core context without a window or a display, current on the thread that made it.
///
/// There is nothing to draw on but framebuffers of one's own. Of the thread that made it.
class Offscreen {
 public:
  /// A surfaceless context of EGL (Mesa has one without any hardware); where there is none, that of a hidden
  /// window. Fails with InvalidArgument and the reasons of both.
  static spheretree::Result<Offscreen> create();

  ~Offscreen();
  Offscreen(Offscreen&&) noexcept;
  Offscreen& operator=(Offscreen&&) noexcept;

 private:
  class Context;
  class EglContext;
  class WindowContext;
  explicit Offscreen(std::unique_ptr<Context> context);

  std::unique_ptr<Context> context_;
};

}  // namespace crowded_room
