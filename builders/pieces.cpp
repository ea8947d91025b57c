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

/// Sorts triangles into two groups at the middle of their longest extent, each in the order they had; returns
/// the size of the first, 0 when they cannot be told apart.
std::size_t divide(std::span<SurfaceCell> all) {
  Eigen::AlignedBox3d box;
  for (const SurfaceCell& cell : all) box.extend(middleOf(cell));
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const double middle = box.center()[axis];
  const auto high = std::stable_partition(
      all.begin(), all.end(), [&](const SurfaceCell& cell) { return middleOf(cell)[axis] <= middle; });
  return high == all.end() ? 0 : static_cast<std::size_t>(high - all.begin());
}

void collect(const SurfaceCell& triangle, double size, std::vector<Piece>& out) {
  if (medial::longestEdge(triangle) <= size) {
    out.push_back(pieceOf({triangle}));
    return;
  }
  const auto [first, second] = medial::bisect(triangle);
  collect(first, size, out);
  collect(second, size, out);
}

/// Sorts the triangles on the way.
void collect(std::span<SurfaceCell> triangles, double size, std::vector<Piece>& out) {
  if (triangles.size() == 1) return collect(triangles.front(), size, out);
  Eigen::AlignedBox3d box;
  for (const SurfaceCell& cell : triangles) {
    for (const Vector3d& p : cell) box.extend(p);
  }
  if (box.diagonal().norm() <= size) {
    out.push_back(pieceOf({triangles.begin(), triangles.end()}));
    return;
  }
  const std::size_t low = divide(triangles);
  if (low == 0) {
    for (const SurfaceCell& cell : triangles) collect(cell, size, out);
    return;
  }
  collect(triangles.first(low), size, out);
  collect(triangles.subspan(low), size, out);
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
  std::vector<SurfaceCell> all = piece.triangles;
  const std::size_t low = std::max<std::size_t>(divide(all), 1);
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(low);
  return {pieceOf({all.begin(), middle}), pieceOf({middle, all.end()})};
}

std::vector<Piece> surfacePieces(std::span<const SurfaceCell> cells, double size) {
  std::vector<Piece> pieces;
  std::vector<SurfaceCell> sorted(cells.begin(), cells.end());
  if (!sorted.empty()) collect(sorted, size, pieces);
  return pieces;
}

}  // namespace spheretree::builders
