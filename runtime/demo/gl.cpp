// SPDX-License-Identifier: MIT
#include "gl.hpp"

#include <string>

namespace crowded_room {

using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;

namespace {

constexpr int kNeededVersion = 33;  // as epoxy counts: 10 times major plus minor

using GetNumber = void (*)(GLuint, GLenum, GLint*);
using GetLog = void (*)(GLuint, GLsizei, GLsizei*, GLchar*);

std::string logOf(GLuint object, GetNumber number, GetLog log) {
  GLint size = 0;
  number(object, GL_INFO_LOG_LENGTH, &size);
  std::string text(static_cast<std::size_t>(size), '\0');
  if (size > 0) log(object, size, nullptr, text.data());
  return text;
}

Result<GLuint> compile(std::string_view name, GLenum stage, std::string_view source) {
  const GLuint shader = glCreateShader(stage);
  const GLchar* text = source.data();
  const auto size = static_cast<GLint>(source.size());
  glShaderSource(shader, 1, &text, &size);
  glCompileShader(shader);
  GLint fine = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &fine);
  if (fine != 0) return shader;
  const std::string log = logOf(shader, glGetShaderiv, glGetShaderInfoLog);
  glDeleteShader(shader);
  return Error{ErrorCode::Internal, "shader '" + std::string(name) + "' does not compile: " + log};
}

}  // namespace

namespace detail {
void deleteBuffer(GLuint id) {
  glDeleteBuffers(1, &id);
}
void deleteVertexArray(GLuint id) {
  glDeleteVertexArrays(1, &id);
}
void deleteTexture(GLuint id) {
  glDeleteTextures(1, &id);
}
void deleteRenderbuffer(GLuint id) {
  glDeleteRenderbuffers(1, &id);
}
void deleteFramebuffer(GLuint id) {
  glDeleteFramebuffers(1, &id);
}
void deleteProgram(GLuint id) {
  glDeleteProgram(id);
}
}  // namespace detail

GlBuffer makeBuffer() {
  GLuint id = 0;
  glGenBuffers(1, &id);
  return GlBuffer(id);
}

GlVertexArray makeVertexArray() {
  GLuint id = 0;
  glGenVertexArrays(1, &id);
  return GlVertexArray(id);
}

GlTexture makeTexture() {
  GLuint id = 0;
  glGenTextures(1, &id);
  return GlTexture(id);
}

GlRenderbuffer makeRenderbuffer() {
  GLuint id = 0;
  glGenRenderbuffers(1, &id);
  return GlRenderbuffer(id);
}

GlFramebuffer makeFramebuffer() {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  return GlFramebuffer(id);
}

void setUniform(const GlProgram& program, const char* name, GLint value) {
  glUniform1i(glGetUniformLocation(program.id(), name), value);
}

const void* bufferOffset(std::size_t bytes) noexcept {
  return reinterpret_cast<const void*>(bytes);
}

bool hasNeededOpenGl() noexcept {
  return epoxy_is_desktop_gl() && epoxy_gl_version() >= kNeededVersion;
}

Result<GlProgram> makeProgram(std::string_view name, std::string_view vertex, std::string_view fragment) {
  const Result<GLuint> vertexStage = compile(name, GL_VERTEX_SHADER, vertex);
  if (!vertexStage) return vertexStage.error();
  const Result<GLuint> fragmentStage = compile(name, GL_FRAGMENT_SHADER, fragment);
  if (!fragmentStage) {
    glDeleteShader(*vertexStage);
    return fragmentStage.error();
  }
  GlProgram program(glCreateProgram());
  for (const GLuint stage : {*vertexStage, *fragmentStage}) {
    glAttachShader(program.id(), stage);
    glDeleteShader(stage);
  }
  glLinkProgram(program.id());
  GLint fine = 0;
  glGetProgramiv(program.id(), GL_LINK_STATUS, &fine);
  if (fine == 0) {
    return Error{ErrorCode::Internal, "shader '" + std::string(name) + "' does not link: " +
                                          logOf(program.id(), glGetProgramiv, glGetProgramInfoLog)};
  }
  return program;
}

}  // namespace crowded_room
