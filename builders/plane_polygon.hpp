// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace spheretree::builders {

/// A half-plane: the points x with normal . x <= offset. The normal has unit length, or is 0:
/// the half-plane is then everything or nothing.
struct HalfPlane {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double offset = 0;
};

/// A convex polygon that remembers which half-plane made each of its edges.
///
/// The edges are kept as half-planes and not as differences of corners: power diagrams of cospherical balls
/// are full of edges of length zero, whose direction only the half-plane knows.
class PlanePolygon {
 public:
  struct Edge {
    HalfPlane line;         ///< of the edge from `start` to the next edge's start
    Eigen::Vector2d start;  ///< counter-clockwise
  };

  /// Starts from a convex polygon given counter-clockwise. Keeps its memory for the next use.
  void assign(std::span<const Edge> edges) { edges_.assign(edges.begin(), edges.end()); }

  [[nodiscard]] bool empty() const noexcept { return edges_.empty(); }
  [[nodiscard]] std::span<const Edge> edges() const noexcept { return edges_; }

  /// Cuts away what lies outside the half-plane.
  void clip(const HalfPlane& cut) {
    const std::size_t count = edges_.size();
    height_.resize(count);
    bool someInside = false;
    bool someOutside = false;
    for (std::size_t k = 0; k < count; ++k) {
      height_[k] = cut.normal.dot(edges_[k].start) - cut.offset;
      (height_[k] <= 0 ? someInside : someOutside) = true;
    }
    if (!someOutside) return;
    next_.clear();
    for (std::size_t k = 0; someInside && k < count; ++k) {
      const std::size_t after = k + 1 == count ? 0 : k + 1;
      const bool inside = height_[k] <= 0;
      if (inside) next_.push_back(edges_[k]);
      if (inside == (height_[after] <= 0)) continue;
      const double along = height_[k] / (height_[k] - height_[after]);
      const Eigen::Vector2d crossing = edges_[k].start + along * (edges_[after].start - edges_[k].start);
      next_.push_back({inside ? cut : edges_[k].line, crossing});
    }
    std::swap(edges_, next_);
  }

  /// Sums piece(p, t) over the right triangles that make up the polygon as seen from the origin: p is the
  /// distance of an edge's line, t the way from its foot to an end of the edge. Signed, so that everything
  /// outside the polygon cancels.
  template <class Piece>
  [[nodiscard]] double sumOverRightTriangles(const Piece& piece) const {
    double sum = 0;
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      const auto& [line, start] = edges_[k];
      const Eigen::Vector2d& end = edges_[k + 1 == edges_.size() ? 0 : k + 1].start;
      const Eigen::Vector2d along(-line.normal.y(), line.normal.x());
      const double p = std::abs(line.offset);
      const auto half = [&](double t) { return std::copysign(piece(p, std::abs(t)), t); };
      sum += std::copysign(1.0, line.offset) * (half(along.dot(end)) - half(along.dot(start)));
    }
    return sum;
  }

 private:
  std::vector<Edge> edges_;
  std::vector<Edge> next_;
  std::vector<double> height_;
};

}  // namespace spheretree::builders
