// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/region.hpp"

#include <utility>

#include "medial/solid_cells.hpp"

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using medial::Surface;

void refineSolid(const Surface& surface, const AlignedBox3d& cube, double size,
                 std::vector<medial::SolidCell>& out) {
  std::vector<Eigen::Vector3d> points = medial::solidPoints(surface, cube, surface.trianglesNear(cube));
  if (points.empty()) return;
  if (cube.sizes().maxCoeff() <= size) {
    out.push_back({cube, std::move(points)});
    return;
  }
  for (const AlignedBox3d& octant : medial::octants(cube)) refineSolid(surface, octant, size, out);
}

}  // namespace

std::vector<Piece> piecesOf(const Surface& surface, const Region& region, const PieceSize& size) {
  std::vector<Piece> pieces = surfacePieces(region.surface, size.surface);
  std::vector<medial::SolidCell> solid;
  for (const AlignedBox3d& cube : region.cubes) refineSolid(surface, cube, size.solid, solid);
  for (medial::SolidCell& cell : solid) {
    Piece piece;
    piece.cube = cell.cube;
    piece.points = std::move(cell.points);
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace spheretree::builders
