// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/pieces.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::SurfaceCell;

auto coordinates(const Vector3d& p) {
  return std::tuple(p.x(), p.y(), p.z());
}

Vector3d middleOf(const SurfaceCell& cell) {
  return (cell[0] + cell[1] + cell[2]) / 3;
}

/// Sorts triangles into two groups at the middle of their longest extent; false when they cannot be told
/// apart.
bool divide(std::span<const SurfaceCell> all, std::vector<SurfaceCell>& low, std::vector<SurfaceCell>& high) {
  Eigen::AlignedBox3d box;
  for (const SurfaceCell& cell : all) box.extend(middleOf(cell));
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const double middle = box.center()[axis];
  for (const SurfaceCell& cell : all) (middleOf(cell)[axis] <= middle ? low : high).push_back(cell);
  return !low.empty() && !high.empty();
}

void collect(std::vector<SurfaceCell> triangles, double size, std::vector<Piece>& out) {
  Eigen::AlignedBox3d box;
  for (const SurfaceCell& cell : triangles) {
    for (const Vector3d& p : cell) box.extend(p);
  }
  if (triangles.size() == 1) {
    if (medial::longestEdge(triangles.front()) <= size) {
      out.push_back(pieceOf(std::move(triangles)));
      return;
    }
    const auto [first, second] = medial::bisect(triangles.front());
    collect({first}, size, out);
    collect({second}, size, out);
    return;
  }
  if (box.diagonal().norm() <= size) {
    out.push_back(pieceOf(std::move(triangles)));
    return;
  }
  std::vector<SurfaceCell> low;
  std::vector<SurfaceCell> high;
  if (!divide(triangles, low, high)) {
    for (const SurfaceCell& cell : triangles) collect({cell}, size, out);
    return;
  }
  triangles = {};
  collect(std::move(low), size, out);
  collect(std::move(high), size, out);
}

}  // namespace

double Piece::size() const {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : points) box.extend(p);
  return box.sizes().maxCoeff();
}

double areaOf(const Piece& piece) {
  double sum = 0;
  for (const SurfaceCell& cell : piece.triangles) sum += medial::areaOf(cell);
  return sum;
}

Piece pieceOf(std::vector<SurfaceCell> triangles) {
  Piece piece;
  for (const SurfaceCell& cell : triangles) piece.points.insert(piece.points.end(), cell.begin(), cell.end());
  if (triangles.size() > 1) {
    std::sort(piece.points.begin(), piece.points.end(),
              [](const Vector3d& a, const Vector3d& b) { return coordinates(a) < coordinates(b); });
    piece.points.erase(std::unique(piece.points.begin(), piece.points.end()), piece.points.end());
  }
  piece.triangles = std::move(triangles);
  return piece;
}

std::pair<Piece, Piece> cut(const Piece& piece) {
  if (piece.triangles.size() == 1) {
    const auto [first, second] = medial::bisect(piece.triangles.front());
    return {pieceOf({first}), pieceOf({second})};
  }
  std::vector<SurfaceCell> low;
  std::vector<SurfaceCell> high;
  if (!divide(piece.triangles, low, high)) {
    low.assign(piece.triangles.begin(), piece.triangles.begin() + 1);
    high.assign(piece.triangles.begin() + 1, piece.triangles.end());
  }
  return {pieceOf(std::move(low)), pieceOf(std::move(high))};
}

std::vector<Piece> surfacePieces(std::span<const SurfaceCell> cells, double size) {
  std::vector<Piece> pieces;
  if (!cells.empty()) collect({cells.begin(), cells.end()}, size, pieces);
  return pieces;
}

}  // namespace spheretree::builders
