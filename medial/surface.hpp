// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <spheretree/result.hpp>

#include "medial/triangle_mesh.hpp"

namespace spheretree::medial {

/// The nearest place of a surface to a query point.
struct ClosestPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double distance = 0;         ///< mesh units, never negative
  std::uint32_t triangle = 0;  ///< the lowest-numbered triangle among the nearest
};

/// An immutable solid given by its closed, oriented boundary, indexed for distance queries.
///
/// A point is inside when the surface winds around it at least once, so nested shells, cavities and
/// overlapping components mean what a modeller means by them. Const members may be called from any number of
/// threads at once. Cheap to move, not copyable.
class Surface {
 public:
  /// Takes the mesh over and indexes it, O(n log n). Fails with UnsuitableMesh when the mesh has no
  /// triangle, a non-finite or out-of-range corner, a size that whyNotMeasurable() objects to, an edge that
  /// is not used equally often in both directions (open or inconsistently oriented), or no positive volume.
  static Result<Surface> create(TriangleMesh mesh);

  Surface(Surface&&) noexcept;
  Surface& operator=(Surface&&) noexcept;
  ~Surface();

  [[nodiscard]] const TriangleMesh& mesh() const noexcept;
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const noexcept;
  [[nodiscard]] double diagonal() const noexcept;
  [[nodiscard]] double volume() const noexcept;  ///< signedVolumeOf(mesh())
  [[nodiscard]] double area() const noexcept;

  /// The closest point of the surface. Expected O(log n), but O(n) from the middle of a ball.
  [[nodiscard]] ClosestPoint closestPoint(const Eigen::Vector3d& point) const;

  /// A point of the surface that is the closest one unless thousands of triangles compete for that, and then
  /// at most a thousandth farther. O(log n) on a ball, from the middle of it. Proves nothing.
  [[nodiscard]] ClosestPoint roughlyClosestPoint(const Eigen::Vector3d& point) const;

  /// Distance to the surface; positive inside, negative outside.
  [[nodiscard]] double depth(const Eigen::Vector3d& point) const;

  /// Winding number test, exact up to the rounding of `point - corner`. O(log n) for a decent mesh.
  [[nodiscard]] bool inside(const Eigen::Vector3d& point) const;

  /// The triangles whose bounding box meets `box`, in ascending order.
  [[nodiscard]] std::vector<std::uint32_t> trianglesNear(const Eigen::AlignedBox3d& box) const;

 private:
  struct Impl;
  explicit Surface(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spheretree::medial
