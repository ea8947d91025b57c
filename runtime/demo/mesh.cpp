// SPDX-License-Identifier: MIT
#include "mesh.hpp"

#include <charconv>
#include <cstddef>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "matrix.hpp"

namespace crowded_room {

using spheretree::Error;
using spheretree::ErrorCode;
using spheretree::Result;
using spheretree::Vec3;

namespace {

namespace fs = std::filesystem;

/// Reads `v` and `f` lines; everything else is passed over.
class ObjReader {
 public:
  /// Nothing, or what is wrong with the line.
  std::string_view take(std::string_view line) {
    std::istringstream words{std::string(line)};
    std::string kind;
    words >> kind;
    if (kind == "v") return takeVertex(words);
    if (kind == "f") return takeFace(words);
    return {};
  }

  Mesh finish() && {
    // The length of the cross product weighs a face by its area.
    for (const auto& [a, b, c] : mesh_.triangles) {
      auto& v = mesh_.vertices;
      const Vec3 normal = cross(v[b].place - v[a].place, v[c].place - v[a].place);
      for (const std::uint32_t corner : {a, b, c}) v[corner].normal = v[corner].normal + normal;
    }
    for (Mesh::Vertex& vertex : mesh_.vertices) vertex.normal = unit(vertex.normal);
    return std::move(mesh_);
  }

 private:
  std::string_view takeVertex(std::istringstream& words) {
    Vec3 p;
    if (!(words >> p.x >> p.y >> p.z)) return "is not a vertex of three numbers";
    mesh_.vertices.push_back({p, {}});
    return {};
  }

  std::string_view takeFace(std::istringstream& words) {
    std::vector<std::uint32_t> corners;
    std::string word;
    while (words >> word) {
      long number = 0;
      const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), number);
      const auto count = static_cast<long>(mesh_.vertices.size());
      if (number < 0) number += count + 1;  // counted from the last
      const bool slash = end == word.data() + word.size() || *end == '/';
      if (problem != std::errc{} || !slash || number < 1 || number > count)
        return "names a vertex that is not there";
      corners.push_back(static_cast<std::uint32_t>(number - 1));
    }
    if (corners.size() < 3) return "is a face of fewer than three corners";
    for (std::size_t k = 2; k < corners.size(); ++k)
      mesh_.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    return {};
  }

  Mesh mesh_;
};

Vec3 axis(std::size_t k) {
  return {k == 0 ? 1.0F : 0.0F, k == 1 ? 1.0F : 0.0F, k == 2 ? 1.0F : 0.0F};
}

}  // namespace

Mesh boxMesh() {
  Mesh mesh;
  for (std::size_t k = 0; k < 3; ++k) {
    for (const float side : {-1.0F, 1.0F}) {
      const Vec3 normal = side * axis(k);
      const Vec3 u = axis((k + 1) % 3);
      const Vec3 v = cross(normal, u);
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const auto& [s, t] : {std::pair{-1.0F, -1.0F}, {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}})
        mesh.vertices.push_back({0.5F * (normal + s * u + t * v), normal});
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  }
  return mesh;
}

Mesh inRoomUnits(Mesh mesh, const UnitTree& tree) {
  for (Mesh::Vertex& vertex : mesh.vertices) vertex.place = tree.scale * (vertex.place - tree.center);
  return mesh;
}

fs::path meshFileOf(const UnitTree& tree) {
  if (tree.file.empty()) return {};
  std::map<std::size_t, fs::path> candidates;  // by the length of the name
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(tree.file.parent_path(), ignored)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() == ".obj" && tree.name.starts_with(stem))
      candidates[stem.size()] = entry.path();
  }
  return candidates.empty() ? fs::path{} : candidates.rbegin()->second;
}

Result<Mesh> readObj(const fs::path& file) {
  std::ifstream text(file);
  if (!text) return Error{ErrorCode::UnreadableInput, file.string() + ": cannot be read"};
  ObjReader reader;
  std::string line;
  for (std::size_t number = 1; std::getline(text, line); ++number) {
    const std::string_view problem = reader.take(line);
    if (!problem.empty()) {
      return Error{ErrorCode::UnreadableInput,
                   file.string() + ": line " + std::to_string(number) + " " + std::string(problem)};
    }
  }
  Mesh mesh = std::move(reader).finish();
  if (mesh.triangles.empty()) return Error{ErrorCode::UnreadableInput, file.string() + ": holds no faces"};
  return mesh;
}

}  // namespace crowded_room
