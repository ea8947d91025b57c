// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <spheretree/result.hpp>
#include <spheretree/vec3.hpp>

#include "tree_library.hpp"

namespace crowded_room {

/// Triangles to draw, in room units around the origin.
struct Mesh {
  struct Vertex {
    spheretree::Vec3 place;
    spheretree::Vec3 normal;  ///< unit, outwards
  };
  std::vector<Vertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The box of the room: edges of length 1, flat faces.
[[nodiscard]] Mesh boxMesh();

/// The faces of an OBJ file with smooth normals; materials, textures and the file's own normals are passed
/// over. Fails with UnreadableInput, naming the file and the line.
spheretree::Result<Mesh> readObj(const std::filesystem::path& file);

/// The mesh as its tree stands in the room.
[[nodiscard]] Mesh inRoomUnits(Mesh mesh, const UnitTree& tree);

/// The OBJ file beside the tree that it was made of: of those whose name begins the tree's name, the one with
/// the longest. An empty path when there is none.
[[nodiscard]] std::filesystem::path meshFileOf(const UnitTree& tree);

}  // namespace crowded_room
