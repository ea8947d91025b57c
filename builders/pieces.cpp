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

// So many needles side by side go into common pieces: one at a time each of them would take as many pieces as
// it is longer than one.
constexpr std::size_t kManyNeedles = 256;
constexpr double kNeedle = 0.1;  // height over length
// A region falls into so many parts of triangles at most, or twice as many as it has: memory goes with them.
constexpr double kMostParts = 100'000;

bool isNeedle(const SurfaceCell& cell) {
  const double longest = medial::longestEdge(cell);
  return 2 * medial::areaOf(cell) < kNeedle * longest * longest;
}

/// Bisects whatever is longer than both half of the group and a piece, so that the group can be divided
/// across its needles.
void shorten(std::vector<SurfaceCell>& triangles, double longest) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    while (medial::longestEdge(triangles[i]) > longest) {
      const auto [first, second] = medial::bisect(triangles[i]);
      triangles[i] = first;
      triangles.push_back(second);
    }
  }
}

enum class Needles : std::uint8_t { Alone, Together };

void collect(std::vector<SurfaceCell> triangles, double size, Needles needles, std::vector<Piece>& out) {
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
    collect({first}, size, needles, out);
    collect({second}, size, needles, out);
    return;
  }
  const double length = box.diagonal().norm();
  if (length <= size) {
    out.push_back(pieceOf(std::move(triangles)));
    return;
  }
  if (needles == Needles::Together) shorten(triangles, std::max(size, length / 2));
  std::vector<SurfaceCell> low;
  std::vector<SurfaceCell> high;
  if (!divide(triangles, low, high)) {
    for (const SurfaceCell& cell : triangles) collect({cell}, size, needles, out);
    return;
  }
  triangles = {};
  collect(std::move(low), size, needles, out);
  collect(std::move(high), size, needles, out);
}

/// `size`, or more where needles would fall into too many parts.
double sizeFor(const std::vector<double>& lengths, double size) {
  const double most = std::max(kMostParts, 2 * static_cast<double>(lengths.size()));
  const auto parts = [&](double at) {
    double sum = 0;
    for (const double length : lengths) sum += std::max(1.0, 2 * length / at);
    return sum;
  };
  constexpr double kStep = 1.25;
  while (parts(size) > most) size *= kStep;
  return size;
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
  if (cells.empty()) return pieces;
  std::vector<double> lengths;  // of needles that are longer than a piece
  for (const SurfaceCell& cell : cells) {
    if (const double length = medial::longestEdge(cell); length > size && isNeedle(cell))
      lengths.push_back(length);
  }
  const bool many = lengths.size() >= kManyNeedles;
  collect({cells.begin(), cells.end()}, many ? sizeFor(lengths, size) : size,
          many ? Needles::Together : Needles::Alone, pieces);
  return pieces;
}

}  // namespace spheretree::builders
