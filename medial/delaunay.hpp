// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "medial/ball.hpp"
#include "medial/surface.hpp"

namespace spheretree::medial {

/// Moves a mesh into the unit cube around the origin and back: predicates and circumcentres like it there.
struct UnitFrame {
  explicit UnitFrame(const Surface& surface)
      : origin(surface.bounds().center()), scale(surface.bounds().sizes().maxCoeff()) {}
  [[nodiscard]] Eigen::Vector3d forward(const Eigen::Vector3d& p) const { return (p - origin) / scale; }
  [[nodiscard]] Eigen::Vector3d backward(const Eigen::Vector3d& p) const { return origin + scale * p; }
  Eigen::Vector3d origin;
  double scale;
};

/// Centre and least of the four distances of the sphere through the corners of a tetrahedron; nothing for a
/// sliver, whose four distances disagree.
[[nodiscard]] std::optional<Ball> circumscribedBall(const std::array<Eigen::Vector3d, 4>& corners);

/// A circumcentre whose four distances disagree by more than this fraction comes from a sliver: not a centre.
inline constexpr double kCircumsphere = 1e-6;
/// Centres closer than this fraction of the diagonal are one Voronoi vertex split by cospherical points.
inline constexpr double kSameCenter = 1e-9;

/// Delaunay tetrahedra of points that may grow in number. Exact predicates; which points a tetrahedron joins
/// depends on nothing but the set of points, cospherical or not. One thread at a time.
class Delaunay {
 public:
  using Corners = std::array<std::uint32_t, 4>;  ///< indices of points

  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// What an insertion did, as tetrahedra. Valid until the next one.
  struct Change {
    std::span<const std::uint32_t> removed;
    std::span<const std::uint32_t> created;
  };

  explicit Delaunay(std::span<const Eigen::Vector3d> points);
  Delaunay(const Delaunay&) = delete;
  Delaunay& operator=(const Delaunay&) = delete;
  ~Delaunay();

  /// How many numbers of tetrahedra were ever given away; numbers are not used twice.
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] bool alive(std::uint32_t tetrahedron) const noexcept;
  [[nodiscard]] const Corners& corners(std::uint32_t tetrahedron) const noexcept;
  /// The living tetrahedron across the facet opposite to a corner, or kNone outside the hull.
  [[nodiscard]] std::uint32_t neighbour(std::uint32_t tetrahedron, std::size_t corner) const;

  /// Adds a point under its index. `near`: a living tetrahedron, best one whose circumsphere holds the
  /// point; or kNone. Nothing changes when the point is there already.
  Change insert(const Eigen::Vector3d& point, std::uint32_t index, std::uint32_t near);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spheretree::medial
