// SPDX-License-Identifier: GPL-3.0-or-later
//
// glTF, Collada, 3DS, FBX and the rest through assimp, https://github.com/assimp/assimp. No post-processing
// step is asked for: the node transforms are multiplied here, in double, and polygons are cut with those of
// the other readers. Hostile files can exhaust its stack or keep it busy for ever, so it works in a process
// of its own, which sends the polygons home as bytes.

#include <assimp/config.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "io/isolated.hpp"
#include "io/mesh_readers.hpp"

namespace spheretree::io {
namespace {

Error broken(const std::string& why) {
  return {ErrorCode::UnreadableInput, why};
}

Eigen::Affine3d affine(const aiMatrix4x4& matrix) {
  Eigen::Affine3d transform;
  transform.matrix() << static_cast<double>(matrix.a1), static_cast<double>(matrix.a2),
      static_cast<double>(matrix.a3), static_cast<double>(matrix.a4), static_cast<double>(matrix.b1),
      static_cast<double>(matrix.b2), static_cast<double>(matrix.b3), static_cast<double>(matrix.b4),
      static_cast<double>(matrix.c1), static_cast<double>(matrix.c2), static_cast<double>(matrix.c3),
      static_cast<double>(matrix.c4), 0, 0, 0, 1;
  return transform;
}

/// Appends one instance of a mesh. Points and lines are no part of a surface.
std::optional<Error> appendMesh(const aiMesh& mesh, const Eigen::Affine3d& transform, PolygonSoup& soup) {
  const std::size_t first = soup.points.size();
  if (first + mesh.mNumVertices > std::numeric_limits<std::uint32_t>::max())
    return broken("too many vertices");
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D& position = mesh.mVertices[v];
    const Eigen::Vector3d point =
        transform * Eigen::Vector3d(static_cast<double>(position.x), static_cast<double>(position.y),
                                    static_cast<double>(position.z));
    if (!point.allFinite())
      return broken("vertex " + std::to_string(v) +
                    " of a mesh has a coordinate that is not a finite number");
    soup.points.push_back(point);
  }
  const bool mirrored = transform.linear().determinant() < 0;
  bool any = false;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices < 3) continue;
    const std::size_t begin = soup.corners.size();
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices) {
        return broken("a face uses vertex " + std::to_string(face.mIndices[k]) + " of " +
                      std::to_string(mesh.mNumVertices));
      }
      soup.corners.push_back(static_cast<std::uint32_t>(first + face.mIndices[k]));
    }
    if (mirrored) std::reverse(soup.corners.begin() + static_cast<std::ptrdiff_t>(begin), soup.corners.end());
    soup.endPolygon();
    any = true;
  }
  if (any) ++soup.meshes;
  return std::nullopt;
}

std::optional<Error> appendNode(const aiScene& scene, const aiNode& node, const Eigen::Affine3d& parent,
                                PolygonSoup& soup) {
  const Eigen::Affine3d transform = parent * affine(node.mTransformation);
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    if (node.mMeshes[m] >= scene.mNumMeshes) return broken("a node names a mesh that is not there");
    const std::optional<Error> error = appendMesh(*scene.mMeshes[node.mMeshes[m]], transform, soup);
    if (error) return error;
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    const std::optional<Error> error = appendNode(scene, *node.mChildren[c], transform, soup);
    if (error) return error;
  }
  return std::nullopt;
}

Result<PolygonSoup> readHere(const std::filesystem::path& path) {
  Assimp::Importer importer;
  std::string extension = path.extension().string();
  if (!importer.IsExtensionSupported(extension))
    return broken("no mesh format is known by the ending " +
                  (extension.empty() ? "of this name" : extension));
  // A file of bones without meshes must not come out as little pyramids.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    std::string reason = importer.GetErrorString();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    return broken(reason.empty() ? "holds no scene" : reason);
  }
  PolygonSoup soup;
  const std::optional<Error> error = appendNode(*scene, *scene->mRootNode, Eigen::Affine3d::Identity(), soup);
  if (error) return *error;
  return soup;
}

// --- the way home: a count of bytes, then the bytes, for each of the three arrays; then the meshes ---

template <class Value>
void append(std::string& bytes, const Value* values, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<Value>);
  const std::size_t size = count * sizeof(Value);
  bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
  bytes.append(reinterpret_cast<const char*>(values), size);
}

template <class Value>
std::vector<Value> taken(std::string_view& bytes) {
  std::size_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof size);
  std::vector<Value> values(size / sizeof(Value));
  if (size > 0) std::memcpy(values.data(), bytes.data() + sizeof size, size);
  bytes.remove_prefix(sizeof size + size);
  return values;
}

std::string packed(const PolygonSoup& soup) {
  std::string bytes;
  append(bytes, soup.points.empty() ? nullptr : soup.points.front().data(), 3 * soup.points.size());
  append(bytes, soup.corners.data(), soup.corners.size());
  append(bytes, soup.polygonEnds.data(), soup.polygonEnds.size());
  append(bytes, &soup.meshes, 1);
  return bytes;
}

PolygonSoup unpacked(std::string_view bytes) {
  PolygonSoup soup;
  const std::vector<double> coordinates = taken<double>(bytes);
  soup.points.reserve(coordinates.size() / 3);
  for (std::size_t k = 0; k < coordinates.size(); k += 3)
    soup.points.emplace_back(coordinates[k], coordinates[k + 1], coordinates[k + 2]);
  soup.corners = taken<std::uint32_t>(bytes);
  soup.polygonEnds = taken<std::size_t>(bytes);
  soup.meshes = taken<std::size_t>(bytes).front();
  return soup;
}

// Time that no decent file takes: a minute, and a second for so many bytes.
constexpr std::chrono::seconds kPatience(60);
constexpr std::uintmax_t kBytesPerSecond = 100'000;

}  // namespace

Result<PolygonSoup> readWithAssimp(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(path, ignored);
  const std::chrono::seconds extra(ignored ? 0 : static_cast<std::int64_t>(size / kBytesPerSecond));
  const Result<std::string> bytes = runIsolated(
      [&]() -> Result<std::string> {
        const Result<PolygonSoup> soup = readHere(path);
        if (!soup) return soup.error();
        return packed(*soup);
      },
      kPatience + extra);
  if (!bytes) return bytes.error();
  return unpacked(*bytes);
}

}  // namespace spheretree::io
