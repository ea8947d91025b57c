// SPDX-License-Identifier: MIT
#include "film.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "gl.hpp"
#include "png.hpp"

namespace crowded_room {

using spheretree::Done;
using spheretree::Error;
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
  constexpr float kBack = 1.28F;  // room lengths from which a wide picture holds it
  camera.setAngles(0.62F, 0.50F);
  camera.setDistance(kBack * std::max(size.x, size.z));
  camera.follow({0.5F * size.x, 0.22F * size.y, 0.5F * size.z});
  camera.setSlope(0.36F);
  return camera;
}

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
  return film;
}

Result<Done> Film::draw(const Room& room) {
  const Result<Done> drawn = stage_->draw(room, cameraAt(options_.view, room), options_.stage, canvas_->fine(),
                                          canvas_->fineSize());
  if (!drawn) return drawn;
  canvas_->average();
  glFinish();
  return Done{};
}

Result<Done> Film::write(std::uint32_t frame) {
  if (!options_.record.empty() && frame % options_.every == 0) {
    std::error_code ignored;  // writing says what is wrong
    fs::create_directories(options_.record, ignored);
    const Result<Done> written = writePng(options_.record / numbered(frame / options_.every), canvas_->read());
    if (!written) return written;
  }
  if (!options_.screenshot.empty() && frame + 1 == options_.frames)
    return writePng(options_.screenshot, canvas_->read());
  return Done{};
}

float Film::take(const Room& room) {
  using Clock = std::chrono::steady_clock;
  const std::uint32_t frame = frame_++;
  if (problem_) return 0;
  stage_->noteContacts(room);
  const bool last = frame + 1 == options_.frames && !options_.screenshot.empty();
  const bool recorded = !options_.record.empty() && frame % options_.every == 0;
  if (!options_.render && !last && !recorded) return 0;
  const auto start = Clock::now();
  Result<Done> result = draw(room);
  const float took = std::chrono::duration<float, std::micro>(Clock::now() - start).count();
  if (result) result = write(frame);
  if (!result) problem_ = result.error();
  return took;
}

}  // namespace crowded_room
