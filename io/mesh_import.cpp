// SPDX-License-Identifier: GPL-3.0-or-later
//
// Mesh files into indexed triangles. OBJ, OFF, PLY and STL have readers of our own, because Debian's assimp
// holds floats: a model far from its origin would be ruined, and no mesh written by this tool would read back
// bit for bit. Everything else goes through assimp.

#include "io/mesh_import.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "io/files.hpp"
#include "io/guarded.hpp"
#include "io/mesh_readers.hpp"
#include "io/soup_cleaning.hpp"

namespace spheretree::io {
namespace {

Result<PolygonSoup> readPolygons(const std::filesystem::path& path, std::string_view bytes) {
  const std::string extension = endingOf(path);
  if (bytes.empty()) return Error{ErrorCode::UnreadableInput, "is empty"};
  if (extension == ".obj") return readObj(bytes);
  if (extension == ".off") return readOff(bytes);
  if (extension == ".ply") return readPly(bytes);
  if (extension == ".stl") return readStl(bytes);
  return readWithAssimp(path);
}

/// The corners after welding, without one that follows its equal.
std::vector<std::uint32_t> weldedCorners(std::span<const std::uint32_t> polygon,
                                         std::span<const std::uint32_t> first) {
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t corner : polygon)
    if (corners.empty() || corners.back() != first[corner]) corners.push_back(first[corner]);
  while (corners.size() > 1 && corners.back() == corners.front()) corners.pop_back();
  return corners;
}

ImportedMesh trianglesOf(PolygonSoup soup) {
  ImportedMesh imported;
  ImportReport& report = imported.report;
  report.meshes = soup.meshes;
  report.polygons = soup.polygonEnds.size();
  const std::vector<std::uint32_t> first = firstAtSamePosition(soup.points);
  for (std::size_t v = 0; v < first.size(); ++v)
    if (first[v] != v) ++report.weldedVertices;

  for (std::size_t p = 0; p < soup.polygonEnds.size(); ++p) {
    const std::span<const std::uint32_t> polygon = soup.polygon(p);
    if (polygon.size() > 3) ++report.triangulated;
    const std::vector<std::uint32_t> corners = weldedCorners(polygon, first);
    // Triangles that the polygon would have given, had its corners not fallen together.
    report.degenerateTriangles +=
        std::max<std::size_t>(polygon.size(), 3) - std::max<std::size_t>(corners.size(), 2);
    if (corners.size() < 3) continue;
    for (const auto& triangle : triangulatePolygon(soup.points, corners))
      imported.mesh.triangles.push_back(triangle);
  }
  imported.mesh.vertices = std::move(soup.points);
  report.degenerateTriangles += removeDegenerate(imported.mesh);
  report.duplicateTriangles = removeDuplicates(imported.mesh);
  imported.mesh = weldVertices(std::move(imported.mesh));
  return imported;
}

}  // namespace

Result<ImportedMesh> importMesh(const std::filesystem::path& path) {
  return guarded(ErrorCode::UnreadableInput, path.string(), [&]() -> Result<ImportedMesh> {
    const auto failed = [&](const std::string& why) {
      return Error{ErrorCode::UnreadableInput, path.string() + ": " + why};
    };
    const Result<std::string> bytes = readFile(path);
    if (!bytes) return bytes.error();
    Result<PolygonSoup> soup = readPolygons(path, bytes.value());
    if (!soup) return failed(soup.error().message);
    if (soup->polygonEnds.empty()) return failed("holds no polygon");
    ImportedMesh imported = trianglesOf(std::move(*soup));
    if (imported.mesh.triangles.empty()) return failed("holds no triangle with an area");
    imported.report.contentHash = contentHash(bytes.value());
    return imported;
  });
}

}  // namespace spheretree::io
