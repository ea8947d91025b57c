// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include <spheretree/result.hpp>

#include "gl.hpp"
#include "image.hpp"

namespace crowded_room {

/// A picture off the screen: drawn finer than it is wanted, then averaged. Lives within one context.
class Canvas {
 public:
  /// Samples along the side of a pixel; a power of two, so that halving averages.
  enum class Fineness : std::uint8_t { One = 1, Two = 2, Four = 4 };

  /// Fails with InvalidArgument when the driver has no pictures of that size.
  static spheretree::Result<Canvas> create(PixelSize size, Fineness fineness);

  /// Where the room is drawn, and its size.
  [[nodiscard]] GLuint fine() const noexcept { return targets_.front().framebuffer.id(); }
  [[nodiscard]] PixelSize fineSize() const noexcept { return targets_.front().size; }
  [[nodiscard]] PixelSize size() const noexcept { return targets_.back().size; }
  /// Averages what is drawn so far into the picture, which is bound for more, such as a panel.
  void average();
  /// The picture, after average().
  [[nodiscard]] Image read() const;

 private:
  struct Target {
    GlRenderbuffer color;
    GlRenderbuffer depth;
    GlFramebuffer framebuffer;
    PixelSize size;
  };
  static spheretree::Result<Target> makeTarget(PixelSize size);

  Canvas() = default;

  std::vector<Target> targets_;  // each half as large as the one before; the last is the picture
};

}  // namespace crowded_room
