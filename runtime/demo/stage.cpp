// SPDX-License-Identifier: MIT
#include "stage.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "overhang.hpp"

namespace crowded_room {

using spheretree::Done;
using spheretree::Node;
using spheretree::Result;

namespace {

constexpr Color kAvatarColor{236, 28, 140, 255};
// Kinds differ in hue, objects in lightness, so that a crowd does not melt into one.
constexpr std::array<Color, 4> kBunnyColors{
    {{240, 226, 204, 255}, {226, 206, 178, 255}, {246, 236, 220, 255}, {214, 190, 160, 255}}};
constexpr std::array<Color, 4> kBoxColors{
    {{72, 118, 178, 255}, {96, 146, 204, 255}, {54, 94, 150, 255}, {122, 166, 214, 255}}};
constexpr std::array<Color, 6> kLevelColors{{{123, 97, 201, 255},
                                             {58, 124, 214, 255},
                                             {32, 166, 160, 255},
                                             {124, 179, 66, 255},
                                             {222, 178, 38, 255},
                                             {190, 120, 60, 255}}};
constexpr Color kTight{70, 170, 90, 255};
constexpr Color kMiddling{245, 222, 120, 255};
constexpr Color kFat{128, 30, 140, 255};

/// A collision glows for about a third of a second.
constexpr float kGlowPerStep = 0.88F;
/// The avatar must still be known by its own colour.
constexpr float kAvatarGlow = 0.4F;
constexpr float kFaintest = 0.02F;

Color mixed(const Color& a, const Color& b, float share) {
  Color color{};
  for (std::size_t k = 0; k < color.size(); ++k) {
    const float value =
        static_cast<float>(a[k]) + share * (static_cast<float>(b[k]) - static_cast<float>(a[k]));
    color[k] = static_cast<std::uint8_t>(std::lround(value));
  }
  return color;
}

Color colorOf(ObjectKind kind, std::uint32_t body) {
  if (kind == ObjectKind::Avatar) return kAvatarColor;
  const std::uint32_t mixedUp = (body * 2654435761U) >> 24U;  // Knuth's multiplier: neighbours differ
  return kind == ObjectKind::Bunny ? kBunnyColors[mixedUp % kBunnyColors.size()]
                                   : kBoxColors[mixedUp % kBoxColors.size()];
}

Color overhangColor(float share) {
  const float twice = 2 * std::clamp(share, 0.0F, 1.0F);
  return twice < 1 ? mixed(kTight, kMiddling, twice) : mixed(kMiddling, kFat, twice - 1);
}

/// The nodes at the level, and those above it that have no children; with their levels.
struct Drawn {
  const Node* node = nullptr;
  std::size_t level = 0;
};

std::vector<Drawn> drawnNodes(const spheretree::SphereTree& tree, std::uint32_t levels) {
  const std::size_t last = std::min<std::size_t>(std::max(levels, 1U), tree.levelCount()) - 1;
  std::vector<Drawn> drawn;
  for (std::size_t level = 0; level <= last; ++level) {
    for (const Node& node : tree.level(level)) {
      if (level == last || node.childCount == 0) drawn.push_back({&node, level});
    }
  }
  return drawn;
}

}  // namespace

Stage::Stage(Renderer renderer) : renderer_(std::move(renderer)) {}

Result<Stage> Stage::create() {
  Result<Renderer> renderer = Renderer::create();
  if (!renderer) return renderer.error();
  Stage stage(std::move(*renderer));
  stage.castOf(ObjectKind::Box).mesh = boxMesh();
  const PaintedBall avatar{{{0, 0, 0}, Room::kAvatarRadius}, {}};
  stage.castOf(ObjectKind::Avatar).model.setBalls(std::span(&avatar, 1));
  return stage;
}

void Stage::noteContacts(const Room& room) {
  glows_.resize(room.bodyCount(), 0);
  for (float& glow : glows_) {
    glow *= kGlowPerStep;
    if (glow < kFaintest) glow = 0;
  }
  for (const spheretree::Contact& contact : room.contacts()) {
    if (!contact.decided) continue;
    glows_[contact.a] = contact.a == 0 ? kAvatarGlow : 1;
    glows_[contact.b] = 1;
  }
}

Result<Done> Stage::dress(Cast& cast, ObjectKind kind, const UnitTree& tree, const StageSettings& settings) {
  if (cast.tree != tree.name) {
    cast.overhangs.clear();
    if (kind == ObjectKind::Bunny) cast.mesh = {};
    const std::filesystem::path file = meshFileOf(tree);
    if (tree.use == TreeUse::Box) {
      cast.mesh = boxMesh();
    } else if (!file.empty()) {
      Result<Mesh> mesh = readObj(file);
      if (!mesh) return mesh.error();
      cast.mesh = inRoomUnits(std::move(*mesh), tree);
    }
    cast.hasMesh = !cast.mesh.triangles.empty();
    if (cast.hasMesh) cast.model.setMesh(cast.mesh);
    cast.tree = tree.name;
  }
  if (cast.paintedTree == tree.name && cast.painted == settings) return Done{};
  if (settings.paint == BallPaint::Overhang && cast.overhangs.empty() && cast.hasMesh)
    cast.overhangs = overhangsOf(tree.tree.nodes(), cast.mesh);
  std::vector<PaintedBall> balls;
  for (const auto& [node, level] : drawnNodes(tree.tree, settings.levels)) {
    Color color{};
    if (settings.paint == BallPaint::Level) color = kLevelColors[level % kLevelColors.size()];
    if (settings.paint == BallPaint::Overhang && cast.hasMesh) {
      // Half the unit cube's edge is more than any ball below the root sticks out.
      constexpr float kMost = 0.25F;
      color =
          overhangColor(cast.overhangs[static_cast<std::size_t>(node - tree.tree.nodes().data())] / kMost);
    }
    balls.push_back({node->ball, color});
  }
  cast.model.setBalls(balls);
  cast.paintedTree = tree.name;
  cast.painted = settings;
  return Done{};
}

void Stage::collect(const Room& room) {
  for (Cast& cast : casts_) cast.instances.clear();
  for (std::uint32_t body = 0; body < room.bodyCount(); ++body) {
    const ObjectKind kind = room.kind(body);
    castOf(kind).instances.push_back({room.place(body), 1, colorOf(kind, body), glows_[body]});
  }
}

Result<Done> Stage::draw(const Room& room, const Camera& camera, const StageSettings& settings,
                         GLuint framebuffer, PixelSize size) {
  glows_.resize(room.bodyCount(), 0);
  std::array<Renderer::Group, 3> groups;
  collect(room);
  for (const ObjectKind kind : {ObjectKind::Avatar, ObjectKind::Bunny, ObjectKind::Box}) {
    Cast& cast = castOf(kind);
    if (kind != ObjectKind::Avatar) {
      const Result<Done> dressed = dress(cast, kind, room.treeOf(kind), settings);
      if (!dressed) return dressed;
    }
    const Look look = cast.hasMesh ? settings.look : Look::Balls;
    groups[static_cast<std::size_t>(kind)] = {&cast.model, look, cast.instances};
  }
  const Renderer::Picture picture{
      camera, room.settings().size, room.place(0), Room::kAvatarRadius, settings.shadows, groups};
  renderer_.draw(picture, framebuffer, size);
  return Done{};
}

}  // namespace crowded_room
