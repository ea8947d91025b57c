// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "medial/surface.hpp"
#include "medial/triangle_mesh.hpp"

namespace spheretree::medial {

/// A four-wide bounding-box hierarchy over the triangles of a mesh, for distance and ray queries.
///
/// Owns copies of the corners in traversal order; the mesh may go away. Const members are thread-safe. The
/// wide instructions of the processor are chosen at run time and give the same bits as the narrow ones.
class TriangleBvh {
 public:
  explicit TriangleBvh(const TriangleMesh& mesh);

  /// The closest triangle; among equals the lowest-numbered one. The mesh must not be empty.
  [[nodiscard]] ClosestPoint closestPoint(const Eigen::Vector3d& point) const;

  /// The same at a bounded cost: where kManyPackets leaves could not settle it, what is found from then on is
  /// at most kRough times as far as the closest point. A cospherical mesh of a million triangles needs that
  /// near its middle, where exactness means to look at each of them.
  [[nodiscard]] ClosestPoint roughlyClosestPoint(const Eigen::Vector3d& point) const;

  static constexpr std::uint32_t kManyPackets = 4096;
  static constexpr double kRough = 1.001;

  /// How often the surface winds around the point: signed crossings of an axis-parallel ray. Which of two
  /// triangles a ray through their common edge crosses is decided by rounding-free comparisons of rounded
  /// coordinates, the same for both, so a closed mesh gives an integer for every point.
  [[nodiscard]] int windingNumber(const Eigen::Vector3d& point) const;

  /// Ascending numbers of the triangles whose box meets `box`.
  [[nodiscard]] std::vector<std::uint32_t> trianglesNear(const Eigen::AlignedBox3d& box) const;

 private:
  static constexpr std::size_t kWidth = 4;

  using Wide = std::array<double, kWidth>;

  /// Four child boxes side by side. Unused slots have an empty box and are never entered.
  struct alignas(32) Node {
    std::array<Wide, 3> low;
    std::array<Wide, 3> high;
    // The same triangles in a box of their own attitude, one axis along their mean normal. A patch of a
    // smooth surface is far thinner than its upright box, and a point far from a round surface sees many
    // upright boxes at nearly the same distance: with these alone it would have to look into sqrt(n) of them.
    std::array<std::array<Wide, 3>, 3> axis;  // [axis][component], unit length
    std::array<Wide, 3> turnedLow;
    std::array<Wide, 3> turnedHigh;
    std::array<std::uint32_t, kWidth> child;  // inner: node index; leaf: packet index
    std::array<std::uint32_t, kWidth> count;  // leaf: triangles in the packet; inner: 0
  };

  /// Up to four triangles side by side. Unused lanes hold NaN, which no comparison selects.
  struct alignas(32) Packet {
    std::array<std::array<Wide, 3>, 3> corner;  // [corner][axis]
    std::array<Wide, 3> normal;                 // unit length; NaN for a sliver, whose edges stand for it
    std::array<Wide, 3> inverseSquaredEdge;     // 1 / |corner[k + 1] - corner[k]|^2
    std::array<std::uint32_t, kWidth> triangle;
  };

  struct Kernels;
  struct Builder;

  std::vector<Node> nodes_;
  std::vector<Packet> packets_;
  Eigen::AlignedBox3d bounds_;
};

}  // namespace spheretree::medial
