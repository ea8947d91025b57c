// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "builders/pieces.hpp"
#include "medial/surface.hpp"
#include "medial/surface_samples.hpp"

namespace spheretree::builders {

/// What one ball has to cover.
struct Region {
  std::vector<medial::SurfaceCell> surface;
  std::vector<Eigen::AlignedBox3d> cubes;  ///< Cover::Solid only; the solid inside them
};

/// Longest sides of pieces, mesh units; infinite: as they are.
struct PieceSize {
  double surface;
  double solid;
};

/// The region in pieces no longer than `size`: those of the surface first.
[[nodiscard]] std::vector<Piece> piecesOf(const medial::Surface& surface, const Region& region,
                                          const PieceSize& size);

}  // namespace spheretree::builders
