// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <spheretree/result.hpp>

namespace spheretree::io {

/// Polygons as a file states them: nothing welded, nothing checked but the corner numbers.
struct PolygonSoup {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::uint32_t> corners;    ///< of all polygons, one after the other; each below points.size()
  std::vector<std::size_t> polygonEnds;  ///< where each polygon ends in `corners`
  std::size_t meshes = 0;                ///< objects or mesh instances with polygons

  [[nodiscard]] std::span<const std::uint32_t> polygon(std::size_t index) const {
    const std::size_t begin = index == 0 ? 0 : polygonEnds[index - 1];
    return std::span(corners).subspan(begin, polygonEnds[index] - begin);
  }
  /// Ends the polygon whose corners were appended last.
  void endPolygon() { polygonEnds.push_back(corners.size()); }
};

// Readers of the formats whose text or binary form can hold doubles, which assimp would cut to floats. All
// take the whole file, never trust an announced count with memory, and fail with UnreadableInput: a reason
// without the file's name, with the line where there is one.

Result<PolygonSoup> readObj(std::string_view text);
Result<PolygonSoup> readOff(std::string_view text);
Result<PolygonSoup> readPly(std::string_view bytes);
Result<PolygonSoup> readStl(std::string_view bytes);

/// Every other format: assimp, node transforms applied in double, the winding of mirrored instances restored. In a
/// process of its own, because there are files that make assimp crash or go on for ever.
Result<PolygonSoup> readWithAssimp(const std::filesystem::path& path);

}  // namespace spheretree::io
