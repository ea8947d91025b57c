// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <spheretree/result.hpp>

#include "camera.hpp"
#include "canvas.hpp"
#include "history.hpp"
#include "offscreen.hpp"
#include "options.hpp"
#include "overlay.hpp"
#include "panel.hpp"
#include "room.hpp"
#include "stage.hpp"
#include "touch.hpp"

namespace crowded_room {

/// Draws a run without a window, frame by frame, and writes pictures of it. Of one thread.
class Film {
 public:
  /// Opens an off-screen context. Fails as Offscreen, Stage and Canvas do.
  static spheretree::Result<std::unique_ptr<Film>> create(const Options& options);

  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// After each step: draws when the options ask for this frame and writes its picture. Returns the
  /// microseconds that drawing took, to the last pixel, without the writing. The first failure is kept, see
  /// problem().
  float take(const Room& room);

  [[nodiscard]] const std::optional<spheretree::Error>& problem() const noexcept { return problem_; }

 private:
  explicit Film(const Options& options);
  spheretree::Result<spheretree::Done> draw(const Room& room);
  spheretree::Result<spheretree::Done> write(std::uint32_t frame);

  void drawPanel(const Room& room, const Camera& camera);

  Options options_;
  std::uint32_t last_;
  // In this order: what lives in the context goes before it does.
  std::optional<Offscreen> context_;
  std::optional<Canvas> canvas_;
  std::optional<Stage> stage_;
  std::optional<Overlay> overlay_;
  Panel panel_;
  bool overlayMeasured_ = false;
  History history_;
  Touch touch_;
  float drawing_ = 0;  // microseconds, of the last picture
  std::uint32_t frame_ = 0;
  std::optional<spheretree::Error> problem_;
};

/// The camera of a viewpoint for a picture of that shape.
[[nodiscard]] Camera cameraAt(Viewpoint view, const Room& room);

/// A stick that flies the avatar around the middle of the room.
[[nodiscard]] StickInput tour(const Room& room);

}  // namespace crowded_room
