// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "medial/triangle_mesh.hpp"

namespace spheretree::medial {

/// A triangle of the surface or a piece of one: the unit in which surface cover is built and proved.
using SurfaceCell = std::array<Eigen::Vector3d, 3>;

/// The two halves of a cell, cut at the midpoint of its longest edge (the lowest-numbered one of those that are
/// equal up to rounding).
///
/// Builders and proofs split with this one function, so a proof that starts from the mesh arrives at exactly
/// the cells that a builder handed to its balls.
[[nodiscard]] std::pair<SurfaceCell, SurfaceCell> bisect(const SurfaceCell& cell);

[[nodiscard]] double longestEdge(const SurfaceCell& cell);
[[nodiscard]] double areaOf(const SurfaceCell& cell);

/// The part of the solid inside a cube: the unit in which solid cover is built and proved.
struct SolidCell {
  Eigen::AlignedBox3d cube;
  /// Their convex hull holds the solid inside the cube (solidPoints()), so a ball that holds them holds it.
  std::vector<Eigen::Vector3d> points;
};

/// What a region of a tree must cover: convex pieces, each given by its corner points.
///
/// Corners are shared: `points` holds each position once, `corners(i)` indexes into it.
class CellSet {
 public:
  CellSet() = default;
  CellSet(std::span<const SurfaceCell> surface, std::span<const SolidCell> solid);
  /// Each cell by the points whose convex hull it is.
  explicit CellSet(std::span<const std::span<const Eigen::Vector3d>> cells);

  [[nodiscard]] std::size_t size() const noexcept { return start_.size() - 1; }
  [[nodiscard]] bool empty() const noexcept { return size() == 0; }
  [[nodiscard]] std::span<const Eigen::Vector3d> points() const noexcept { return points_; }
  [[nodiscard]] std::span<const std::uint32_t> corners(std::size_t cell) const noexcept {
    return std::span(corners_).subspan(start_[cell], start_[cell + 1] - start_[cell]);
  }
  /// Squared distance from `center` to the farthest corner of a cell.
  [[nodiscard]] double farthestSquared(std::size_t cell, const Eigen::Vector3d& center) const;

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint32_t> start_{0};
};

}  // namespace spheretree::medial
