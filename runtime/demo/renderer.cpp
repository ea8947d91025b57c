// SPDX-License-Identifier: MIT
//
// Two passes: the depths as the sun sees them into a shadow map that spans the room, then the room and the
// groups with one instanced draw call each. Balls are fetched from buffer textures by the number of the
// vertex, so a tree lies on the graphics card once and an object costs 24 bytes a frame, whatever it looks
// like.
#include "renderer.hpp"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "matrix.hpp"
#include "shaders.hpp"

namespace crowded_room {

using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;
using spheretree::Vec3;

namespace {

constexpr GLsizei kShadowSide = 2048;  // texels; 7 cm a texel in the paper's room
constexpr GLint kVerticesPerBall = 6;
constexpr GLsizei kRoomVertices = 36;
constexpr Vec3 kTowardsSun{0.42F, 1.0F, 0.30F};
constexpr float kGridLines = 10;  // room units between the strong lines
constexpr Color kBackground{44, 53, 64, 255};

// Texture units and the binding point of the scene.
constexpr GLint kShadowUnit = 0;
constexpr GLint kBallUnit = 1;
constexpr GLint kColorUnit = 2;
constexpr GLuint kSceneBinding = 0;

// Locations that the shaders name.
constexpr GLuint kPlaceAndScale = 0;
constexpr GLuint kInstanceColor = 1;
constexpr GLuint kGlow = 2;
constexpr GLuint kCorner = 3;
constexpr GLuint kCornerNormal = 4;

Result<GlProgram> makeSceneProgram(std::string_view name, const shaders::Sources& sources) {
  Result<GlProgram> program = makeProgram(name, sources.vertex, sources.fragment);
  if (!program) return program;
  const GLuint id = program->id();
  glUniformBlockBinding(id, glGetUniformBlockIndex(id, "Scene"), kSceneBinding);
  glUseProgram(id);
  setUniform(*program, "shadowMap", kShadowUnit);
  setUniform(*program, "balls", kBallUnit);
  setUniform(*program, "ballColors", kColorUnit);
  return program;
}

void describeFloats(GLuint attribute, GLint count, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(attribute);
  glVertexAttribPointer(attribute, count, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                        bufferOffset(offset));
}

/// Of the bound vertex array and the bound buffer.
void describeInstances() {
  describeFloats(kPlaceAndScale, 4, sizeof(Instance), offsetof(Instance, place));
  describeFloats(kGlow, 1, sizeof(Instance), offsetof(Instance, glow));
  glEnableVertexAttribArray(kInstanceColor);
  glVertexAttribPointer(kInstanceColor, 4, GL_UNSIGNED_BYTE, GL_TRUE, static_cast<GLsizei>(sizeof(Instance)),
                        bufferOffset(offsetof(Instance, color)));
  for (const GLuint attribute : {kPlaceAndScale, kInstanceColor, kGlow}) glVertexAttribDivisor(attribute, 1);
}

/// The box of the eight corners of the room in the coordinates of `view`.
std::pair<Vec3, Vec3> extentOf(Vec3 size, const Matrix& view) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  Vec3 low{kInfinite, kInfinite, kInfinite};
  Vec3 high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = transformPoint(view, {(corner & 1) != 0 ? size.x : 0, (corner & 2) != 0 ? size.y : 0,
                                         (corner & 4) != 0 ? size.z : 0});
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {low, high};
}

Matrix sunProjectionOf(Vec3 roomSize) {
  const Vec3 middle = 0.5F * roomSize;
  const Matrix view = lookAt(middle + kTowardsSun, middle, {0, 0, 1});
  const auto [low, high] = extentOf(roomSize, view);
  return orthographic(low, high) * view;
}

/// From the cube that is drawn (-1 to 1) to that of a texture (0 to 1).
Matrix toTexture() {
  Matrix half;
  half.m = {0.5F, 0, 0, 0, 0, 0.5F, 0, 0, 0, 0, 0.5F, 0, 0.5F, 0.5F, 0.5F, 1};
  return half;
}

GlTexture makeShadowMap() {
  GlTexture map = makeTexture();
  glBindTexture(GL_TEXTURE_2D, map.id());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, kShadowSide, kShadowSide, 0, GL_DEPTH_COMPONENT,
               GL_FLOAT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  return map;
}

void bindBufferTexture(GLint unit, const GlTexture& texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_BUFFER, texture.id());
}

}  // namespace

// std140: matrices and vectors of four only, so nothing is padded.
struct Renderer::SceneBlock {
  Matrix viewProjection;
  Matrix sunProjection;
  std::array<float, 4> viewer{};
  std::array<float, 4> sun{};
  std::array<float, 4> room{};
  std::array<float, 4> avatar{};
};

Renderer::Model::Model()
    : meshArray_(makeVertexArray()), ballArray_(makeVertexArray()), instances_(makeBuffer()) {
  for (const GlVertexArray* array : {&meshArray_, &ballArray_}) {
    glBindVertexArray(array->id());
    glBindBuffer(GL_ARRAY_BUFFER, instances_.id());
    describeInstances();
  }
  glBindVertexArray(0);
}

void Renderer::Model::setMesh(const Mesh& mesh) {
  glBindVertexArray(meshArray_.id());
  vertices_ = makeBuffer(GL_ARRAY_BUFFER, std::span<const Mesh::Vertex>(mesh.vertices));
  describeFloats(kCorner, 3, sizeof(Mesh::Vertex), offsetof(Mesh::Vertex, place));
  describeFloats(kCornerNormal, 3, sizeof(Mesh::Vertex), offsetof(Mesh::Vertex, normal));
  indices_ =
      makeBuffer(GL_ELEMENT_ARRAY_BUFFER, std::span<const std::array<std::uint32_t, 3>>(mesh.triangles));
  glBindVertexArray(0);
  indexCount_ = static_cast<GLsizei>(3 * mesh.triangles.size());
}

void Renderer::Model::setBalls(std::span<const PaintedBall> balls) {
  std::vector<spheretree::Sphere> places;
  std::vector<Color> colors;
  for (const PaintedBall& ball : balls) {
    places.push_back(ball.ball);
    colors.push_back(ball.color);
  }
  ballPlaces_ = makeBuffer(GL_TEXTURE_BUFFER, std::span<const spheretree::Sphere>(places));
  ballColors_ = makeBuffer(GL_TEXTURE_BUFFER, std::span<const Color>(colors));
  ballPlacesView_ = makeTexture();
  glBindTexture(GL_TEXTURE_BUFFER, ballPlacesView_.id());
  glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, ballPlaces_.id());
  ballColorsView_ = makeTexture();
  glBindTexture(GL_TEXTURE_BUFFER, ballColorsView_.id());
  glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA8, ballColors_.id());
  ballCount_ = static_cast<GLsizei>(balls.size());
}

void Renderer::upload(const SceneBlock& scene) {
  glBindBuffer(GL_UNIFORM_BUFFER, sceneBuffer_.id());
  glBufferData(GL_UNIFORM_BUFFER, sizeof(SceneBlock), &scene, GL_STREAM_DRAW);
  glBindBufferBase(GL_UNIFORM_BUFFER, kSceneBinding, sceneBuffer_.id());
}

void Renderer::drawGroups(const GlProgram& meshProgram, const GlProgram& ballProgram,
                          std::span<const Group> groups) {
  for (const Group& group : groups) {
    const Model& model = *group.model;
    const auto count = static_cast<GLsizei>(group.instances.size());
    if (count == 0) continue;
    if (group.look == Look::Mesh) {
      glUseProgram(meshProgram.id());
      glBindVertexArray(model.meshArray_.id());
      glDrawElementsInstanced(GL_TRIANGLES, model.indexCount_, GL_UNSIGNED_INT, nullptr, count);
    } else {
      glUseProgram(ballProgram.id());
      bindBufferTexture(kBallUnit, model.ballPlacesView_);
      bindBufferTexture(kColorUnit, model.ballColorsView_);
      glBindVertexArray(model.ballArray_.id());
      glDrawArraysInstanced(GL_TRIANGLES, 0, kVerticesPerBall * model.ballCount_, count);
    }
  }
  glBindVertexArray(0);
}

void Renderer::drawShadows(const SceneBlock& scene, std::span<const Group> groups) {
  SceneBlock fromSun = scene;
  fromSun.viewProjection = scene.sunProjection;
  fromSun.viewer = {scene.sun[0], scene.sun[1], scene.sun[2], 0};
  upload(fromSun);
  glBindFramebuffer(GL_FRAMEBUFFER, shadowTarget_.id());
  glViewport(0, 0, kShadowSide, kShadowSide);
  glClear(GL_DEPTH_BUFFER_BIT);
  drawGroups(meshShadow_, ballsShadow_, groups);
}

Result<Renderer> Renderer::create() {
  Renderer renderer;
  struct Wanted {
    const char* name;
    shaders::Sources sources;
    GlProgram* program;
  };
  const std::array<Wanted, 5> wanted{{{"mesh", shaders::mesh(), &renderer.mesh_},
                                      {"mesh shadow", shaders::meshShadow(), &renderer.meshShadow_},
                                      {"balls", shaders::balls(), &renderer.balls_},
                                      {"balls shadow", shaders::ballsShadow(), &renderer.ballsShadow_},
                                      {"room", shaders::room(), &renderer.room_}}};
  for (const Wanted& one : wanted) {
    Result<GlProgram> program = makeSceneProgram(one.name, one.sources);
    if (!program) return program.error();
    *one.program = std::move(*program);
  }
  renderer.sceneBuffer_ = makeBuffer();
  renderer.emptyArray_ = makeVertexArray();
  renderer.shadowMap_ = makeShadowMap();
  renderer.shadowTarget_ = makeFramebuffer();
  glBindFramebuffer(GL_FRAMEBUFFER, renderer.shadowTarget_.id());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, renderer.shadowMap_.id(), 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  if (!complete) return Error{ErrorCode::Internal, "the graphics driver has no depth texture to draw on"};
  return renderer;
}

void Renderer::draw(const Picture& picture, GLuint framebuffer, PixelSize size) {
  for (const Group& group : picture.groups) {
    glBindBuffer(GL_ARRAY_BUFFER, group.model->instances_.id());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(group.instances.size_bytes()),
                 group.instances.data(), GL_STREAM_DRAW);
  }
  const bool shadows = picture.shadows == Shadows::On;
  const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  const Vec3 eye = picture.camera.eye();
  const Vec3 sun = unit(kTowardsSun);
  const Matrix fromSun = sunProjectionOf(picture.roomSize);
  SceneBlock scene{picture.camera.viewProjection(aspect),
                   fromSun,
                   {eye.x, eye.y, eye.z, 1},
                   {sun.x, sun.y, sun.z, shadows ? 1.0F : 0.0F},
                   {picture.roomSize.x, picture.roomSize.y, picture.roomSize.z, kGridLines},
                   {picture.avatar.x, picture.avatar.y, picture.avatar.z, picture.avatarRadius}};

  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
  if (shadows) drawShadows(scene, picture.groups);

  scene.sunProjection = toTexture() * fromSun;
  upload(scene);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, size.width, size.height);
  const auto share = [](std::uint8_t byte) { return static_cast<float>(byte) / 255.0F; };
  glClearColor(share(kBackground[0]), share(kBackground[1]), share(kBackground[2]), 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(kShadowUnit));
  glBindTexture(GL_TEXTURE_2D, shadowMap_.id());

  glEnable(GL_CULL_FACE);  // a wall is there from inside only, or it would hide the room
  glUseProgram(room_.id());
  glBindVertexArray(emptyArray_.id());
  glDrawArrays(GL_TRIANGLES, 0, kRoomVertices);
  glDisable(GL_CULL_FACE);
  drawGroups(mesh_, balls_, picture.groups);
}

}  // namespace crowded_room
