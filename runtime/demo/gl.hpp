// SPDX-License-Identifier: MIT
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

#include <spheretree/result.hpp>

namespace crowded_room {

/// Owns one OpenGL object. The context that made it must be current when it goes.
template <void (*Delete)(GLuint)>
class GlHandle {
 public:
  GlHandle() = default;
  explicit GlHandle(GLuint id) noexcept : id_(id) {}
  ~GlHandle() { reset(); }
  GlHandle(GlHandle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  GlHandle& operator=(GlHandle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, 0);
    }
    return *this;
  }
  GlHandle(const GlHandle&) = delete;
  GlHandle& operator=(const GlHandle&) = delete;

  [[nodiscard]] GLuint id() const noexcept { return id_; }
  [[nodiscard]] explicit operator bool() const noexcept { return id_ != 0; }

 private:
  void reset() noexcept {
    if (id_ != 0) Delete(id_);
    id_ = 0;
  }

  GLuint id_ = 0;
};

namespace detail {
void deleteBuffer(GLuint id);
void deleteVertexArray(GLuint id);
void deleteTexture(GLuint id);
void deleteRenderbuffer(GLuint id);
void deleteFramebuffer(GLuint id);
void deleteProgram(GLuint id);
}  // namespace detail

using GlBuffer = GlHandle<detail::deleteBuffer>;
using GlVertexArray = GlHandle<detail::deleteVertexArray>;
using GlTexture = GlHandle<detail::deleteTexture>;
using GlRenderbuffer = GlHandle<detail::deleteRenderbuffer>;
using GlFramebuffer = GlHandle<detail::deleteFramebuffer>;
using GlProgram = GlHandle<detail::deleteProgram>;

[[nodiscard]] GlBuffer makeBuffer();
[[nodiscard]] GlVertexArray makeVertexArray();
[[nodiscard]] GlTexture makeTexture();
[[nodiscard]] GlRenderbuffer makeRenderbuffer();
[[nodiscard]] GlFramebuffer makeFramebuffer();

/// A buffer bound to `target` and filled with `items`.
template <class T>
[[nodiscard]] GlBuffer makeBuffer(GLenum target, std::span<const T> items) {
  GlBuffer buffer = makeBuffer();
  glBindBuffer(target, buffer.id());
  glBufferData(target, static_cast<GLsizeiptr>(items.size_bytes()), items.data(), GL_STATIC_DRAW);
  return buffer;
}

/// Compiles and links. Fails with Internal and the driver's log.
spheretree::Result<GlProgram> makeProgram(std::string_view name, std::string_view vertex,
                                          std::string_view fragment);

/// Sets a sampler or another whole number of the current program; nothing when the program has none of that
/// name.
void setUniform(const GlProgram& program, const char* name, GLint value);

/// What glVertexAttribPointer wants for a place in a buffer.
[[nodiscard]] const void* bufferOffset(std::size_t bytes) noexcept;

/// True when the current context has OpenGL 3.3 or later.
[[nodiscard]] bool hasNeededOpenGl() noexcept;

}  // namespace crowded_room
