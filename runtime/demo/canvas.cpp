// SPDX-License-Identifier: MIT
#include "canvas.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

namespace crowded_room {

using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;

Result<Canvas::Target> Canvas::makeTarget(PixelSize size) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  const std::string wanted = std::to_string(size.width) + " x " + std::to_string(size.height);
  if (std::max(size.width, size.height) > largest) {
    return Error{ErrorCode::InvalidArgument, "a picture of " + wanted +
                                                 " samples is too large for this driver, " +
                                                 std::to_string(largest) + " is its limit"};
  }
  Target target{makeRenderbuffer(), makeRenderbuffer(), makeFramebuffer(), size};
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.id());
  glBindRenderbuffer(GL_RENDERBUFFER, target.color.id());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, size.width, size.height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target.color.id());
  glBindRenderbuffer(GL_RENDERBUFFER, target.depth.id());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, size.width, size.height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, target.depth.id());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return Error{ErrorCode::InvalidArgument, "the graphics driver has no picture of " + wanted + " samples"};
  return target;
}

Result<Canvas> Canvas::create(PixelSize size, Fineness fineness) {
  Canvas canvas;
  for (int factor = static_cast<int>(fineness); factor >= 1; factor /= 2) {
    Result<Target> target = makeTarget({size.width * factor, size.height * factor});
    if (!target) return target.error();
    canvas.targets_.push_back(std::move(*target));
  }
  return canvas;
}

void Canvas::average() {
  for (std::size_t k = 1; k < targets_.size(); ++k) {
    const Target& from = targets_[k - 1];
    const Target& to = targets_[k];
    glBindFramebuffer(GL_READ_FRAMEBUFFER, from.framebuffer.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to.framebuffer.id());
    // Half as large, so every pixel lies in the middle of four and becomes their mean.
    glBlitFramebuffer(0, 0, from.size.width, from.size.height, 0, 0, to.size.width, to.size.height,
                      GL_COLOR_BUFFER_BIT, GL_LINEAR);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, targets_.back().framebuffer.id());
  glViewport(0, 0, size().width, size().height);
}

Image Canvas::read() const {
  const auto width = static_cast<std::size_t>(size().width);
  const auto height = static_cast<std::size_t>(size().height);
  const std::size_t row = 3 * width;
  Image image{size(), std::vector<std::uint8_t>(row * height)};
  glBindFramebuffer(GL_FRAMEBUFFER, targets_.back().framebuffer.id());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size().width, size().height, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
  for (std::size_t y = 0; y < height / 2; ++y) {  // OpenGL counts rows from below
    const auto top = image.rgb.begin() + static_cast<std::ptrdiff_t>(y * row);
    std::swap_ranges(top, top + static_cast<std::ptrdiff_t>(row),
                     image.rgb.begin() + static_cast<std::ptrdiff_t>((height - 1 - y) * row));
  }
  return image;
}

}  // namespace crowded_room
