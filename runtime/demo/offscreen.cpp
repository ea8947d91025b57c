// SPDX-License-Identifier: MIT
//
// EGL_MESA_platform_surfaceless, EGL_KHR_surfaceless_context: a display that is no display, and a context
// that is current without a surface. The hidden window is for drivers that have neither.
#include "offscreen.hpp"

#include <SDL.h>
#include <epoxy/egl.h>

#include <array>
#include <string>
#include <utility>

#include "gl.hpp"

namespace crowded_room {

using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;

class Offscreen::Context {
 public:
  Context() = default;
  virtual ~Context() = default;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
};

class Offscreen::EglContext final : public Offscreen::Context {
 public:
  ~EglContext() override {
    if (display_ == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    // The display is not terminated: EGL has one for the whole process, and others may have contexts of it.
    if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  }

  /// Nothing, or the reason why there is no context.
  std::string open() {
    if (!epoxy_has_egl()) return "there is no EGL library";
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless") ||
        !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base"))
      return "EGL knows no surfaceless platform";
    display_ = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    EGLint major = 0;
    EGLint minor = 0;
    if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, &major, &minor) == EGL_FALSE)
      return "EGL has no surfaceless display";
    if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return "EGL has no OpenGL";
    constexpr std::array<EGLint, 5> kConfig{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                            EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (eglChooseConfig(display_, kConfig.data(), &config, 1, &count) == EGL_FALSE || count == 0)
      config = EGL_NO_CONFIG_KHR;  // a context without a surface needs none
    constexpr std::array<EGLint, 7> kWanted{EGL_CONTEXT_MAJOR_VERSION,
                                            3,
                                            EGL_CONTEXT_MINOR_VERSION,
                                            3,
                                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                            EGL_NONE};
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, kWanted.data());
    if (context_ == EGL_NO_CONTEXT ||
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE || !hasNeededOpenGl())
      return "EGL makes no OpenGL 3.3 core context";
    return {};
  }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

class Offscreen::WindowContext final : public Offscreen::Context {
 public:
  ~WindowContext() override {
    if (context_ != nullptr) SDL_GL_DeleteContext(context_);
    if (window_ != nullptr) SDL_DestroyWindow(window_);
    if (video_) SDL_QuitSubSystem(SDL_INIT_VIDEO);
  }

  /// Nothing, or the reason why there is no context.
  std::string open() {
    video_ = SDL_InitSubSystem(SDL_INIT_VIDEO) == 0;
    if (!video_) return SDL_GetError();
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
    constexpr int kSide = 16;  // nobody will see it
    window_ = SDL_CreateWindow("", 0, 0, kSide, kSide, SDL_WINDOW_OPENGL | SDL_WINDOW_HIDDEN);
    if (window_ == nullptr) return SDL_GetError();
    context_ = SDL_GL_CreateContext(window_);
    if (context_ == nullptr) return SDL_GetError();
    return hasNeededOpenGl() ? "" : "the window has no OpenGL 3.3";
  }

 private:
  bool video_ = false;
  SDL_Window* window_ = nullptr;
  SDL_GLContext context_ = nullptr;
};

Offscreen::Offscreen(std::unique_ptr<Context> context) : context_(std::move(context)) {}
Offscreen::~Offscreen() = default;
Offscreen::Offscreen(Offscreen&&) noexcept = default;
Offscreen& Offscreen::operator=(Offscreen&&) noexcept = default;

Result<Offscreen> Offscreen::create() {
  std::string reasons;
  {
    auto egl = std::make_unique<EglContext>();
    reasons = egl->open();
    if (reasons.empty()) return Offscreen(std::move(egl));
  }
  auto window = std::make_unique<WindowContext>();
  const std::string more = window->open();
  if (more.empty()) return Offscreen(std::move(window));
  return Error{ErrorCode::InvalidArgument,
               "cannot draw off-screen: " + reasons + "; a hidden window does not open either: " + more};
}

}  // namespace crowded_room
