// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "medial/cell_set.hpp"
#include "medial/surface.hpp"

namespace spheretree::builders {

/// A part of what a level covers that one ball holds as a whole: some triangles near each other, a piece of
/// one triangle, or the solid inside a cube.
struct Piece {
  std::vector<medial::SurfaceCell> triangles;  ///< empty for a piece of the solid
  Eigen::AlignedBox3d cube;                    ///< of a piece of the solid
  std::vector<Eigen::Vector3d> points;         ///< a ball that holds these holds the piece; each once

  /// Longest extent of its points along an axis, mesh units.
  [[nodiscard]] double size() const;
};

/// Squared distance from `center` to the farthest of its points.
[[nodiscard]] double farthestSquared(const Piece& piece, const Eigen::Vector3d& center);

/// Of its triangles; 0 for a piece of the solid.
[[nodiscard]] double areaOf(const Piece& piece);

[[nodiscard]] Piece pieceOf(std::vector<medial::SurfaceCell> triangles);

/// The two halves of a piece of the surface: its triangles sorted into two groups, or its one triangle
/// bisected.
[[nodiscard]] std::pair<Piece, Piece> cut(const Piece& piece);

/// The surface in pieces no longer than `size`: small triangles grouped, large ones cut, along a
/// space-filling order that depends on the shape alone. Thousands of needles are cut into pieces together,
/// and into longer ones where they would otherwise fall into more than two parts each and 100,000 in all.
[[nodiscard]] std::vector<Piece> surfacePieces(std::span<const medial::SurfaceCell> cells, double size);

}  // namespace spheretree::builders
