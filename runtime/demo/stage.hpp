// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <spheretree/result.hpp>

#include "camera.hpp"
#include "image.hpp"
#include "renderer.hpp"
#include "room.hpp"

namespace crowded_room {

/// What colours the balls of a tree.
enum class BallPaint : std::uint8_t {
  Object,   ///< the colour of the object
  Level,    ///< how deep the ball is; branches may end above the level that is drawn
  Overhang  ///< how far the ball sticks out of its mesh, from green to violet
};

/// How the room is to be seen.
struct StageSettings {
  Look look = Look::Mesh;
  std::uint32_t levels = 3;  ///< deepest level of balls drawn, the root counts
  BallPaint paint = BallPaint::Level;
  Shadows shadows = Shadows::On;

  friend constexpr bool operator==(const StageSettings&, const StageSettings&) = default;
};

/// Puts a room on the screen: gives bodies their colours, lets those glow that have just collided, and keeps
/// meshes and balls on the graphics card for as long as the trees stay the same.
///
/// Lives within one context.
class Stage {
 public:
  /// Fails as Renderer::create() does.
  static spheretree::Result<Stage> create();

  /// Notes which bodies touch; once after each step.
  void noteContacts(const Room& room);
  /// Draws the room on a framebuffer. Fails when the mesh file of a tree is broken; a tree without a mesh is
  /// drawn as balls.
  spheretree::Result<spheretree::Done> draw(const Room& room, const Camera& camera,
                                            const StageSettings& settings, GLuint framebuffer,
                                            PixelSize size);

 private:
  /// One kind of object, with what its model was made of.
  struct Cast {
    Renderer::Model model;
    std::string tree;  // whose mesh is in the model; empty before the first
    bool hasMesh = false;
    Mesh mesh;
    std::string paintedTree;
    StageSettings painted;
    std::vector<float> overhangs;  // per node, measured when first asked for
    std::vector<Instance> instances;
  };

  explicit Stage(Renderer renderer);
  spheretree::Result<spheretree::Done> dress(Cast& cast, ObjectKind kind, const UnitTree& tree,
                                             const StageSettings& settings);
  void collect(const Room& room);
  [[nodiscard]] Cast& castOf(ObjectKind kind) noexcept { return casts_[static_cast<std::size_t>(kind)]; }

  Renderer renderer_;
  std::array<Cast, 3> casts_;  // by kind
  std::vector<float> glows_;   // by body
};

}  // namespace crowded_room
