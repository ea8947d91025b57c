// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <spheretree/result.hpp>
#include <spheretree/sphere.hpp>
#include <spheretree/vec3.hpp>

#include "camera.hpp"
#include "gl.hpp"
#include "image.hpp"
#include "mesh.hpp"

namespace crowded_room {

/// Red, green, blue, each 0 to 255 (sRGB), and a fourth byte that the user of the colour explains.
using Color = std::array<std::uint8_t, 4>;

/// One object of the crowd, as the graphics card reads it.
struct Instance {
  spheretree::Vec3 place;
  float scale = 1;
  Color color{};   ///< the fourth byte is not used
  float glow = 0;  ///< 0: its own colour, 1: that of a collision
};

/// One ball of a tree as it is drawn: its own colour counts as much as the fourth byte says, from 0 (the
/// colour of the object) to 255.
struct PaintedBall {
  spheretree::Sphere ball;
  Color color{};
};

/// The form that a kind of object is drawn in.
enum class Look : std::uint8_t { Mesh, Balls };
enum class Shadows : std::uint8_t { On, Off };

/// Draws the room with OpenGL 3.3: one call per kind of object, whatever their number.
///
/// Lives within one context, which must be current whenever it is used.
class Renderer {
 public:
  /// A kind of object: triangles, balls, or both.
  class Model {
   public:
    Model();
    void setMesh(const Mesh& mesh);
    void setBalls(std::span<const PaintedBall> balls);

   private:
    friend class Renderer;
    GlVertexArray meshArray_;
    GlVertexArray ballArray_;
    GlBuffer vertices_;
    GlBuffer indices_;
    GlBuffer instances_;
    GlBuffer ballPlaces_;
    GlBuffer ballColors_;
    GlTexture ballPlacesView_;
    GlTexture ballColorsView_;
    GLsizei indexCount_ = 0;
    GLsizei ballCount_ = 0;
  };

  /// All objects of one kind.
  struct Group {
    Model* model = nullptr;
    Look look = Look::Mesh;
    std::span<const Instance> instances;
  };

  /// What a picture shows.
  struct Picture {
    Camera camera;
    spheretree::Vec3 roomSize;
    spheretree::Vec3 avatar;
    float avatarRadius = 1;
    Shadows shadows = Shadows::On;
    std::span<const Group> groups;
  };

  /// Compiles the shaders. Fails with Internal and the driver's log.
  static spheretree::Result<Renderer> create();

  /// Draws on the framebuffer of that number (0: the window's), all of it.
  void draw(const Picture& picture, GLuint framebuffer, PixelSize size);

 private:
  Renderer() = default;
  struct SceneBlock;
  void drawShadows(const SceneBlock& scene, std::span<const Group> groups);
  void drawGroups(const GlProgram& meshProgram, const GlProgram& ballProgram, std::span<const Group> groups);
  void upload(const SceneBlock& scene);

  GlProgram mesh_;
  GlProgram meshShadow_;
  GlProgram balls_;
  GlProgram ballsShadow_;
  GlProgram room_;
  GlBuffer sceneBuffer_;
  GlVertexArray emptyArray_;
  GlTexture shadowMap_;
  GlFramebuffer shadowTarget_;
};

}  // namespace crowded_room
