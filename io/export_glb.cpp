// SPDX-License-Identifier: GPL-3.0-or-later
//
// Binary glTF 2.0 (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html): one small ball of triangles in
// the buffer, one mesh per level that shows it in the level's colour, one node per level, and below it one
// node per ball that moves and scales it. All levels but the last are translucent.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "io/export_formats.hpp"
#include "io/tree_levels.hpp"

namespace spheretree::io {
namespace {

using Eigen::Vector3f;
using Json = nlohmann::ordered_json;
using Triangle = std::array<std::uint16_t, 3>;

// An icosahedron with each triangle split in four twice: 320 triangles, round enough for the size of a ball.
constexpr int kSplits = 2;
constexpr double kVeil = 0.18;  // opacity of the levels above the last

// Numbers of the specification.
constexpr int kFloat = 5126;
constexpr int kUnsignedShort = 5123;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;
constexpr std::uint32_t kMagic = 0x46546C67;  // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinaryChunk = 0x004E4942;

struct UnitBall {
  std::vector<Vector3f> vertices;
  std::vector<Triangle> triangles;
};

UnitBall icosahedron() {
  const auto g = static_cast<float>(std::numbers::phi);
  UnitBall ball;
  for (const float a : {-1.0F, 1.0F}) {
    for (const float b : {-g, g}) {
      ball.vertices.emplace_back(a, b, 0.0F);
      ball.vertices.emplace_back(0.0F, a, b);
      ball.vertices.emplace_back(b, 0.0F, a);
    }
  }
  for (Vector3f& v : ball.vertices) v.normalize();
  // Faces are the triples of vertices at the distance of an edge from each other.
  const float edge = 2 / std::sqrt(g * std::sqrt(5.0F)) * 1.01F;
  const auto near = [&](std::size_t a, std::size_t b) {
    return (ball.vertices[a] - ball.vertices[b]).norm() < edge;
  };
  for (std::size_t a = 0; a < ball.vertices.size(); ++a) {
    for (std::size_t b = a + 1; b < ball.vertices.size(); ++b) {
      for (std::size_t c = b + 1; c < ball.vertices.size(); ++c) {
        if (!near(a, b) || !near(b, c) || !near(a, c)) continue;
        const Vector3f& p = ball.vertices[a];
        const bool outwards = (ball.vertices[b] - p).cross(ball.vertices[c] - p).dot(p) > 0;
        ball.triangles.push_back({static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(outwards ? b : c),
                                  static_cast<std::uint16_t>(outwards ? c : b)});
      }
    }
  }
  return ball;
}

UnitBall split(const UnitBall& ball) {
  UnitBall finer{ball.vertices, {}};
  std::map<std::pair<std::uint16_t, std::uint16_t>, std::uint16_t> middles;
  const auto middle = [&](std::uint16_t a, std::uint16_t b) {
    const auto [at, isNew] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint16_t>(finer.vertices.size()));
    if (isNew) finer.vertices.push_back((ball.vertices[a] + ball.vertices[b]).normalized());
    return at->second;
  };
  for (const auto& [a, b, c] : ball.triangles) {
    const std::uint16_t ab = middle(a, b);
    const std::uint16_t bc = middle(b, c);
    const std::uint16_t ca = middle(c, a);
    for (const Triangle& part :
         {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}})
      finer.triangles.push_back(part);
  }
  return finer;
}

void append(std::string& bytes, std::uint32_t value, unsigned size) {
  for (unsigned k = 0; k < size; ++k) bytes += static_cast<char>(value >> (8 * k) & 255U);
}

/// Colours that are told apart with any kind of colour vision (Okabe, Ito 2008), level by level.
Json colourOf(std::size_t level, bool last) {
  constexpr std::array<std::array<double, 3>, 7> kColours{{{0.84, 0.37, 0.0},
                                                           {0.90, 0.62, 0.0},
                                                           {0.0, 0.62, 0.45},
                                                           {0.34, 0.71, 0.91},
                                                           {0.0, 0.45, 0.70},
                                                           {0.80, 0.47, 0.65},
                                                           {0.50, 0.50, 0.50}}};
  const auto& c = kColours[level % kColours.size()];
  // Factors are linear, the colours above as a screen shows them.
  const auto linear = [](double value) { return std::pow(value, 2.2); };
  return {linear(c[0]), linear(c[1]), linear(c[2]), last ? 1.0 : kVeil};
}

Json ballNode(const Sphere& ball, std::size_t mesh) {
  const auto r = static_cast<double>(ball.radius);
  return {{"mesh", mesh},
          {"translation",
           {static_cast<double>(ball.center.x), static_cast<double>(ball.center.y),
            static_cast<double>(ball.center.z)}},
          {"scale", {r, r, r}}};
}

/// Meshes, materials and nodes of the levels.
void addLevels(Json& gltf, const ExportSource& source, std::span<const std::size_t> levels) {
  Json nodes = Json::array();
  Json roots = Json::array();
  Json meshes = Json::array();
  Json materials = Json::array();
  for (const std::size_t level : levels) {
    const std::string name = "level " + std::to_string(level);
    const bool last = level == levels.back();
    materials.push_back(
        {{"name", name},
         {"alphaMode", last ? "OPAQUE" : "BLEND"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", colourOf(level, last)}, {"metallicFactor", 0}, {"roughnessFactor", 0.6}}}});
    const std::size_t mesh = meshes.size();
    const Json ball = {{"attributes", {{"POSITION", 0}, {"NORMAL", 0}}}, {"indices", 1}, {"material", mesh}};
    meshes.push_back({{"name", name}, {"primitives", Json::array({ball})}});
    Json children = Json::array();
    for (const std::size_t place : nodesAtLevel(source.file.tree, level).nodes) {
      children.push_back(nodes.size());
      nodes.push_back(ballNode(source.file.tree.nodes()[place].ball, mesh));
    }
    roots.push_back(nodes.size());
    nodes.push_back({{"name", name}, {"children", std::move(children)}});
  }
  gltf["scene"] = 0;
  gltf["scenes"] = Json::array({Json::object({{"name", source.name}, {"nodes", std::move(roots)}})});
  gltf["nodes"] = std::move(nodes);
  gltf["meshes"] = std::move(meshes);
  gltf["materials"] = std::move(materials);
}

/// The two accessors of the ball; returns its bytes. A unit ball's normals are its vertices.
std::string addBall(Json& gltf) {
  UnitBall ball = icosahedron();
  for (int k = 0; k < kSplits; ++k) ball = split(ball);
  std::string bytes;
  Vector3f low = ball.vertices.front();
  Vector3f high = low;
  for (const Vector3f& v : ball.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
    for (int k = 0; k < 3; ++k) append(bytes, std::bit_cast<std::uint32_t>(v[k]), 4);
  }
  const std::size_t vertexBytes = bytes.size();
  for (const Triangle& triangle : ball.triangles) {
    for (const std::uint16_t corner : triangle) append(bytes, corner, 2);
  }
  const auto listOf = [](const Vector3f& v) { return Json{v.x(), v.y(), v.z()}; };
  const Json vertices = {{"bufferView", 0}, {"componentType", kFloat}, {"count", ball.vertices.size()},
                         {"type", "VEC3"},  {"min", listOf(low)},      {"max", listOf(high)}};
  const Json corners = {{"bufferView", 1},
                        {"componentType", kUnsignedShort},
                        {"count", 3 * ball.triangles.size()},
                        {"type", "SCALAR"}};
  gltf["accessors"] = Json::array({vertices, corners});
  const Json vertexView = {
      {"buffer", 0}, {"byteOffset", 0}, {"byteLength", vertexBytes}, {"target", kArrayBuffer}};
  const Json cornerView = {{"buffer", 0},
                           {"byteOffset", vertexBytes},
                           {"byteLength", bytes.size() - vertexBytes},
                           {"target", kElementArrayBuffer}};
  gltf["bufferViews"] = Json::array({vertexView, cornerView});
  gltf["buffers"] = Json::array({Json::object({{"byteLength", bytes.size()}})});
  return bytes;
}

void appendChunk(std::string& file, std::uint32_t kind, std::string content) {
  while (content.size() % 4 != 0) content += kind == kJsonChunk ? ' ' : '\0';
  append(file, static_cast<std::uint32_t>(content.size()), 4);
  append(file, kind, 4);
  file += content;
}

}  // namespace

std::string exportGlb(const ExportSource& source, std::span<const std::size_t> levels) {
  Json gltf = {{"asset", {{"version", "2.0"}, {"generator", "spheretree"}}}};
  addLevels(gltf, source, levels);
  const std::string ball = addBall(gltf);
  std::string chunks;
  appendChunk(chunks, kJsonChunk, gltf.dump(-1, ' ', false, Json::error_handler_t::replace));
  appendChunk(chunks, kBinaryChunk, ball);
  constexpr std::uint32_t kHeader = 12;
  std::string file;
  append(file, kMagic, 4);
  append(file, 2, 4);
  append(file, kHeader + static_cast<std::uint32_t>(chunks.size()), 4);
  return file + chunks;
}

}  // namespace spheretree::io
