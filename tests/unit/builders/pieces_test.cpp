// SPDX-License-Identifier: GPL-3.0-or-later
#include "builders/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "solids.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector3d;
using medial::SurfaceCell;

/// A flat disc of needles around its middle.
std::vector<SurfaceCell> fan(std::uint32_t needles) {
  std::vector<SurfaceCell> cells;
  const auto rim = [&](std::uint32_t k) {
    const double angle = 2 * std::numbers::pi * k / needles;
    return Vector3d(std::cos(angle), std::sin(angle), 0);
  };
  for (std::uint32_t k = 0; k < needles; ++k)
    cells.push_back({Vector3d::Zero(), rim(k), rim((k + 1) % needles)});
  return cells;
}

std::vector<SurfaceCell> cellsOf(const medial::TriangleMesh& mesh) {
  std::vector<SurfaceCell> cells;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    cells.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
  return cells;
}

double areaOfAll(const std::vector<Piece>& pieces) {
  double sum = 0;
  for (const Piece& piece : pieces) sum += areaOf(piece);
  return sum;
}

double longestOf(const std::vector<Piece>& pieces) {
  double longest = 0;
  for (const Piece& piece : pieces) longest = std::max(longest, piece.size());
  return longest;
}

TEST(Pieces, AreTheSurfaceInPartsOfTheSizeAskedFor) {
  for (const medial::TriangleMesh& mesh :
       {models::makeBox({1, 2, 3}), models::makeTorus(1, 0.3, 48, 24), models::makeCylinder(1, 1, 600)}) {
    const std::vector<SurfaceCell> cells = cellsOf(mesh);
    double area = 0;
    for (const SurfaceCell& cell : cells) area += medial::areaOf(cell);
    const std::vector<Piece> pieces = surfacePieces(cells, 0.25);
    EXPECT_NEAR(areaOfAll(pieces), area, 1e-9 * area);
    EXPECT_LE(longestOf(pieces), 0.25);
  }
}

TEST(Pieces, AreAsManyForAFanOfNeedlesAsForItsArea) {
  constexpr double kSize = 0.1;
  // Pieces halve until they are short enough, so most are about half as long as they may be.
  const double most = 16 * std::numbers::pi / (kSize * kSize);
  for (const std::uint32_t needles : {2000U, 3000U, 4000U}) {
    const std::vector<Piece> pieces = surfacePieces(fan(needles), kSize);
    EXPECT_LT(static_cast<double>(pieces.size()), most) << needles;
    EXPECT_LE(longestOf(pieces), kSize) << needles;
    EXPECT_NEAR(areaOfAll(pieces), std::numbers::pi, 0.01) << needles;
  }
}

TEST(Pieces, AreLongerWhereNeedlesWouldFallIntoTooManyParts) {
  constexpr std::uint32_t kNeedles = 30'000;
  const std::vector<Piece> pieces = surfacePieces(fan(kNeedles), 0.01);
  std::size_t parts = 0;
  for (const Piece& piece : pieces) parts += piece.triangles.size();
  EXPECT_GE(parts, kNeedles);
  EXPECT_LE(parts, 4 * 100'000U);  // bisecting overshoots by a factor of two each for length and side
  EXPECT_NEAR(areaOfAll(pieces), std::numbers::pi, 1e-6);
}

}  // namespace
}  // namespace spheretree::builders
