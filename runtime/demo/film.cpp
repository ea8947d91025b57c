// SPDX-License-Identifier: MIT
#include "film.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <system_error>
#include <utility>

#include "gl.hpp"
#include "png.hpp"
#include "stick_view.hpp"

namespace crowded_room {

using spheretree::Done;
using spheretree::Result;
using spheretree::Vec3;

namespace {

namespace fs = std::filesystem;

std::string numbered(std::uint32_t number) {
  std::array<char, 16> name{};
  std::snprintf(name.data(), name.size(), "%05u.png", number);
  return name.data();
}

}  // namespace

Camera cameraAt(Viewpoint view, const Room& room) {
  Camera camera;
  if (view == Viewpoint::Avatar) {
    constexpr float kDistance = 17;
    camera.setAngles(0.5F, 0.30F);
    camera.setDistance(kDistance);
    camera.follow(room.place(0));
    return camera;
  }
  const Vec3 size = room.settings().size;
  constexpr float kBack = 1.6F;  // room lengths from which a wide picture holds it
  camera.setAngles(0.62F, 0.50F);
  camera.setDistance(kBack * std::max(size.x, size.z));
  camera.follow({0.5F * size.x, -0.15F * size.y, 0.5F * size.z});
  camera.setSlope(0.36F);
  return camera;
}

StickInput tour(const Room& room) {
  constexpr float kRound = 9;    // seconds
  constexpr float kRise = 4;     // seconds
  constexpr float kFirm = 0.8F;  // tilt
  const float seconds = static_cast<float>(room.stepsMade()) / kFrameRate;
  const float turn = 2 * std::numbers::pi_v<float> * seconds / kRound;
  const float height = 2 * std::numbers::pi_v<float> * seconds / kRise;
  StickInput input;
  input.stick = {kFirm * std::cos(turn), 0.3F * std::sin(height), -kFirm * std::sin(turn)};
  return input;
}

Film::Film(const Options& options)
    : options_(options), last_(options.frames.value_or(Options::kHeadlessFrames) - 1) {}

Film::~Film() = default;

Result<std::unique_ptr<Film>> Film::create(const Options& options) {
  std::unique_ptr<Film> film(new Film(options));
  Result<Offscreen> context = Offscreen::create();
  if (!context) return context.error();
  film->context_ = std::move(*context);
  Result<Canvas> canvas = Canvas::create(options.size, options.fineness);
  if (!canvas) return canvas.error();
  film->canvas_ = std::move(*canvas);
  Result<Stage> stage = Stage::create();
  if (!stage) return stage.error();
  film->stage_ = std::move(*stage);
  if (options.panel) film->overlay_.emplace();
  return film;
}

void Film::drawPanel(const Room& room, const Camera& camera) {
  const Vec3 tilt = camera.toStick(room.consumed().input.stick);
  // Dear ImGui hides a window for the frame in which it measures it.
  for (int pass = overlayMeasured_ ? 1 : 0; pass < 2; ++pass) {
    overlay_->begin(options_.size);
    panel_.draw(room, options_.stage, options_.view, history_, "a run without a window");
    drawStick({tilt, tilt, Hand::Joystick, touch_.kick(), {}, touch_.hits()}, options_.size);
    overlay_->end();
  }
  overlayMeasured_ = true;
}

Result<Done> Film::draw(const Room& room) {
  const Camera camera = cameraAt(options_.view, room);
  const Result<Done> drawn = stage_->draw(room, camera, options_.stage, canvas_->fine(), canvas_->fineSize());
  if (!drawn) return drawn;
  canvas_->average();
  if (overlay_) drawPanel(room, camera);
  glFinish();
  return Done{};
}

Result<Done> Film::write(std::uint32_t frame) {
  if (!options_.record.empty() && frame % options_.every == 0) {
    std::error_code ignored;  // writing says what is wrong
    fs::create_directories(options_.record, ignored);
    const Result<Done> written =
        writePng(options_.record / numbered(frame / options_.every), canvas_->read());
    if (!written) return written;
  }
  if (!options_.screenshot.empty() && frame == last_) return writePng(options_.screenshot, canvas_->read());
  return Done{};
}

float Film::take(const Room& room) {
  using Clock = std::chrono::steady_clock;
  const std::uint32_t frame = frame_++;
  if (problem_) return 0;
  stage_->noteContacts(room);
  touch_.feel(room, cameraAt(options_.view, room));
  const spheretree::StepTimes& times = room.report().collision;
  history_.add({times.update, times.broad, times.narrow, drawing_});
  const bool shot = frame == last_ && !options_.screenshot.empty();
  const bool recorded = !options_.record.empty() && frame % options_.every == 0;
  if (!options_.render && !shot && !recorded) return 0;
  const auto start = Clock::now();
  Result<Done> result = draw(room);
  drawing_ = std::chrono::duration<float, std::micro>(Clock::now() - start).count();
  if (result) result = write(frame);
  if (!result) problem_ = result.error();
  return drawing_;
}

}  // namespace crowded_room
