// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/pieces.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
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

double lengthOf(std::span<const SurfaceCell> triangles) {
  Eigen::AlignedBox3d box;
  for (const SurfaceCell& cell : triangles) {
    for (const Vector3d& p : cell) box.extend(p);
  }
  return box.diagonal().norm();
}

/// Sorts the triangles on the way.
void collect(std::span<SurfaceCell> triangles, double size, std::vector<Piece>& out) {
  if (triangles.size() == 1) return collect(triangles.front(), size, out);
  if (lengthOf(triangles) <= size) {
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

// Needles that would fall into more pieces than this go into common ones: one at a time each of them takes as
// many as it is longer than a piece. Fewer are better alone: common pieces are rounder, and so reach farther.
constexpr double kManyPieces = 20'000;
constexpr double kNeedle = 0.1;  // height over length
// A region falls into so many parts of triangles at most, or twice as many as it has: memory goes with them.
constexpr double kMostParts = 100'000;

bool isNeedle(const SurfaceCell& cell) {
  const double longest = medial::longestEdge(cell);
  return 2 * medial::areaOf(cell) < kNeedle * longest * longest;
}

/// As collect(), for needles: what is longer than both half of the group and a piece is bisected first, so
/// that the group can be divided across its needles.
void collectNeedles(std::vector<SurfaceCell> triangles, double size, std::vector<Piece>& out) {
  const double length = lengthOf(triangles);
  if (triangles.size() == 1 || length <= size) return collect(triangles, size, out);
  const double longest = std::max(size, length / 2);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    while (medial::longestEdge(triangles[i]) > longest) {
      const auto [first, second] = medial::bisect(triangles[i]);
      triangles[i] = first;
      triangles.push_back(second);
    }
  }
  const std::size_t low = divide(triangles);
  if (low == 0) return collect(triangles, size, out);
  const auto middle = triangles.begin() + static_cast<std::ptrdiff_t>(low);
  std::vector<SurfaceCell> high(middle, triangles.end());
  triangles.erase(middle, triangles.end());
  collectNeedles(std::move(triangles), size, out);
  collectNeedles(std::move(high), size, out);
}

/// How many parts needles of these lengths fall into, at most.
double partsOf(const std::vector<double>& lengths, double size) {
  double sum = 0;
  for (const double length : lengths) sum += std::max(1.0, 2 * length / size);
  return sum;
}

/// `size`, or more where needles would fall into too many parts.
double sizeFor(const std::vector<double>& lengths, double size) {
  const double most = std::max(kMostParts, 2 * static_cast<double>(lengths.size()));
  constexpr double kStep = 1.25;
  while (partsOf(lengths, size) > most) size *= kStep;
  return size;
}

}  // namespace

double Piece::size() const {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : points) box.extend(p);
  return box.sizes().maxCoeff();
}

double farthestSquared(const Piece& piece, const Eigen::Vector3d& center) {
  double most = 0;
  for (const Eigen::Vector3d& p : piece.points) most = std::max(most, (p - center).squaredNorm());
  return most;
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
  if (cells.empty()) return pieces;
  std::vector<double> lengths;  // of needles that are longer than a piece
  for (const SurfaceCell& cell : cells) {
    if (const double length = medial::longestEdge(cell); length > size && isNeedle(cell))
      lengths.push_back(length);
  }
  std::vector<SurfaceCell> sorted(cells.begin(), cells.end());
  if (partsOf(lengths, size) > kManyPieces) {
    collectNeedles(std::move(sorted), sizeFor(lengths, size), pieces);
  } else {
    collect(sorted, size, pieces);
  }
  return pieces;
}

}  // namespace spheretree::builders
