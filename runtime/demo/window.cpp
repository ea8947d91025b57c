// SPDX-License-Identifier: MIT
//
// One loop: devices, as many steps as time has passed, a picture. A step always lasts 1/60 s, so a screen of
// another rate shows the same room; a machine that is too slow shows it in slow motion.
#include "window.hpp"

#include <SDL.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "film.hpp"
#include "gl.hpp"
#include "history.hpp"
#include "overlay.hpp"
#include "panel.hpp"
#include "pilot.hpp"
#include "stage.hpp"
#include "stick_view.hpp"

namespace crowded_room {

using spheretree::Done;
using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;

namespace {

using Clock = std::chrono::steady_clock;

constexpr float kStep = 1.0F / kFrameRate;
constexpr float kSlack = 0.1F * kStep;  // a screen of 60 Hz is never exactly that
constexpr int kMostSteps = 4;           // to make up for in one frame
constexpr float kMouseTurn = 0.006F;    // radians per pixel
constexpr float kStickTurn = 2.2F;      // radians per second at full tilt
constexpr float kWheelZoom = 1.1F;
constexpr float kTurnDeadZone = 0.15F;
constexpr int kSamples = 4;

struct CloseWindow {
  void operator()(SDL_Window* window) const noexcept { SDL_DestroyWindow(window); }
};
struct CloseContext {
  void operator()(void* context) const noexcept { SDL_GL_DeleteContext(context); }
};
struct QuitVideo {
  ~QuitVideo() { SDL_QuitSubSystem(SDL_INIT_VIDEO); }
};

/// The window and all that lives in it.
class Play {
 public:
  Play(const Options& options, Room room) : options_(options), room_(std::move(room)) {}

  /// Empty, or why there is no window.
  std::string open();
  Result<Done> run();

 private:
  std::string openContext(int samples);
  void listen();
  void press(SDL_Scancode key);
  void look(Viewpoint view);
  void turnView(float seconds);
  Result<Done> step(float seconds);
  Result<Done> draw();
  void drawOverlay(PixelSize size);

  Options options_;
  Room room_;
  // In this order: what lives in the context goes before it does.
  std::optional<QuitVideo> video_;
  std::unique_ptr<SDL_Window, CloseWindow> window_;
  std::unique_ptr<void, CloseContext> context_;
  std::optional<Stage> stage_;
  std::optional<Overlay> overlay_;
  std::optional<Pilot> pilot_;
  Panel panel_;
  Camera camera_;
  History history_;
  float due_ = 0;  // seconds not stepped yet
  float rendering_ = 0;
  bool showsPanel_ = true;
  bool ended_ = false;
};

std::string Play::openContext(int samples) {
  SDL_GL_SetAttribute(SDL_GL_MULTISAMPLEBUFFERS, samples > 0 ? 1 : 0);
  SDL_GL_SetAttribute(SDL_GL_MULTISAMPLESAMPLES, samples);
  window_.reset(SDL_CreateWindow("The crowded room", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED,
                                 options_.size.width, options_.size.height,
                                 SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE));
  if (!window_) return SDL_GetError();
  context_.reset(SDL_GL_CreateContext(window_.get()));
  if (!context_) return SDL_GetError();
  return hasNeededOpenGl() ? "" : "the driver has no OpenGL 3.3";
}

std::string Play::open() {
  if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) return SDL_GetError();
  video_.emplace();
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_DEPTH_SIZE, 24);
  std::string reason = openContext(kSamples);
  if (!reason.empty()) reason = openContext(0);
  if (reason.empty()) SDL_GL_SetSwapInterval(1);
  return reason;
}

void Play::look(Viewpoint view) {
  options_.view = view;
  camera_ = cameraAt(view, room_);
}

void Play::press(SDL_Scancode key) {
  switch (key) {
    case SDL_SCANCODE_ESCAPE:
      ended_ = true;
      break;
    case SDL_SCANCODE_SPACE:
      room_.setFlow(room_.flow() == Flow::Running ? Flow::Paused : Flow::Running);
      break;
    case SDL_SCANCODE_N:
      room_.setFlow(Flow::Paused);
      room_.askForStep();
      break;
    case SDL_SCANCODE_M:
      options_.stage.look = options_.stage.look == Look::Mesh ? Look::Balls : Look::Mesh;
      break;
    case SDL_SCANCODE_C:
      look(options_.view == Viewpoint::Avatar ? Viewpoint::Room : Viewpoint::Avatar);
      break;
    case SDL_SCANCODE_H:
      showsPanel_ = !showsPanel_;
      break;
    default:
      if (key >= SDL_SCANCODE_1 && key <= SDL_SCANCODE_9)
        options_.stage.levels = static_cast<std::uint32_t>(key - SDL_SCANCODE_1) + 1;
      break;
  }
}

void Play::listen() {
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) {
    const bool taken = overlay_->handle(event);
    if (event.type == SDL_QUIT) ended_ = true;
    if (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_FOCUS_LOST)
      pilot_->releaseKeys();
    if (taken) continue;
    pilot_->handle(event);
    if (event.type == SDL_KEYDOWN && event.key.repeat == 0) press(event.key.keysym.scancode);
    if (event.type == SDL_CONTROLLERBUTTONDOWN && event.cbutton.button == SDL_CONTROLLER_BUTTON_START)
      press(SDL_SCANCODE_SPACE);
    if (event.type == SDL_MOUSEMOTION && (event.motion.state & SDL_BUTTON_RMASK) != 0)
      camera_.turn(-kMouseTurn * static_cast<float>(event.motion.xrel),
                   kMouseTurn * static_cast<float>(event.motion.yrel));
    if (event.type == SDL_MOUSEWHEEL) camera_.zoom(event.wheel.y > 0 ? kWheelZoom : 1 / kWheelZoom);
  }
  if (const auto news = pilot_->news()) std::fprintf(stderr, "crowded_room: %s\n", news->c_str());
}

void Play::turnView(float seconds) {
  const Gamepad::Turn turn = pilot_->gamepad().turn();
  const spheretree::Vec3 tilt = withoutDeadZone({turn.x, 0, turn.y}, kTurnDeadZone);
  camera_.turn(-kStickTurn * seconds * tilt.x, kStickTurn * seconds * tilt.z);
}

Result<Done> Play::step(float seconds) {
  due_ = std::min(due_ + seconds, kMostSteps * kStep);
  while (due_ >= kStep - kSlack) {
    due_ -= kStep;
    const Result<bool> stepped = room_.tick(pilot_->input(camera_));
    if (!stepped) return stepped.error();
    if (!*stepped) continue;
    pilot_->feel(room_, camera_);
    stage_->noteContacts(room_);
    const spheretree::StepTimes& times = room_.report().collision;
    history_.add({times.update, times.broad, times.narrow, rendering_});
  }
  return Done{};
}

void Play::drawOverlay(PixelSize size) {
  overlay_->begin(size);
  if (showsPanel_) {
    Viewpoint view = options_.view;
    panel_.draw(room_, options_.stage, view, history_, pilot_->gamepad().status());
    if (view != options_.view) look(view);
  }
  pilot_->drag(drawStick(pilot_->shown(room_, camera_), size).value_or(spheretree::Vec3{}));
  overlay_->end();
}

Result<Done> Play::draw() {
  const auto start = Clock::now();
  PixelSize pixels;
  SDL_GL_GetDrawableSize(window_.get(), &pixels.width, &pixels.height);
  PixelSize points;
  SDL_GetWindowSize(window_.get(), &points.width, &points.height);
  if (pixels.width > 0 && pixels.height > 0) {
    if (options_.view == Viewpoint::Avatar) camera_.follow(room_.place(0));
    const Result<Done> drawn = stage_->draw(room_, camera_, options_.stage, 0, pixels);
    if (!drawn) return drawn;
    drawOverlay(points);
  }
  glFinish();  // or the time would be somebody else's
  rendering_ = std::chrono::duration<float, std::micro>(Clock::now() - start).count();
  SDL_GL_SwapWindow(window_.get());
  pilot_->presented();
  return Done{};
}

Result<Done> Play::run() {
  Result<Stage> stage = Stage::create();
  if (!stage) return stage.error();
  stage_ = std::move(*stage);
  overlay_.emplace(window_.get());
  pilot_.emplace();
  look(options_.view);
  auto last = Clock::now();
  for (std::uint32_t frame = 0; !ended_ && frame < options_.frames.value_or(frame + 1); ++frame) {
    listen();
    const auto now = Clock::now();
    const float seconds = std::chrono::duration<float>(now - last).count();
    last = now;
    turnView(seconds);
    Result<Done> result = step(seconds);
    if (result) result = draw();
    if (!result) return result;
  }
  return Done{};
}

}  // namespace

Result<Done> runWindow(const Options& options, const TreeLibrary& library) {
  Result<Room> room = Room::create(options.room, library);
  if (!room) return room.error();
  Play play(options, std::move(*room));
  const std::string reason = play.open();
  if (!reason.empty())
    return Error{ErrorCode::InvalidArgument,
                 "no window can be opened (" + reason + "); --headless and --screenshot need none"};
  return play.run();
}

}  // namespace crowded_room
