// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volume of the solid in a cube outside a union of balls.
//
// Summary: the surface in a small cube lies on few planes. If all of it is behind each of them, the solid in
// the cube is the cube cut by these planes; if all of it is in front of each, the *empty* part of the cube
// is. Both are convex, and the volume of a union of balls in a convex polyhedron has a closed form
// (union_volume.hpp). The guess is checked with the inside test: every cap that a plane cuts off has a corner
// of the cube.

#include "builders/solid_gap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "builders/union_volume.hpp"
#include "medial/solid_cells.hpp"

namespace spheretree::builders {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using medial::Ball;
using medial::Surface;

/// With more triangles than this the cube is better split.
constexpr std::size_t kMostTriangles = 12;
/// A point is on a plane when it is this near, as a fraction of the diagonal: far above the rounding of
/// clipped corners, and the volume at stake is as small a fraction of the cube's.
constexpr double kFlat = 1e-11;
/// Rounding of a piece of a ball, as a fraction of the cubed radius.
constexpr double kVolumeRounding = 1e-14;

using Polyhedron = std::vector<HalfSpace>;

Polyhedron sidesOf(const AlignedBox3d& cube) {
  Polyhedron sides;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    sides.push_back({Vector3d::Unit(axis), cube.max()[axis]});
    sides.push_back({-Vector3d::Unit(axis), -cube.min()[axis]});
  }
  return sides;
}

/// What the balls leave of a polyhedron inside the cube, without regard to sign or rounding.
double leftOver(const Polyhedron& polyhedron, const AlignedBox3d& cube, std::span<const Ball> balls) {
  const Ball around{cube.center(), cube.diagonal().norm()};
  return unionVolumeIn(std::array{around}, polyhedron) - unionVolumeIn(balls, polyhedron);
}

/// The surface in a cube: the planes of its triangles, outward, and the corners of its pieces.
struct Patch {
  Polyhedron planes;
  std::vector<Vector3d> points;
};

std::optional<Patch> patchIn(const Surface& surface, const AlignedBox3d& cube,
                             std::span<const std::uint32_t> triangles) {
  Patch patch;
  for (const std::uint32_t t : triangles) {
    const auto piece = medial::surfacePoints(surface, cube, std::span(&t, 1));
    if (piece.size() < 3) continue;  // touches the cube at most
    const auto corner = [&](std::size_t k) { return surface.mesh().corner(t, k); };
    const Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    if (!(normal.norm() > 0.5) || patch.planes.size() == kMostTriangles) return std::nullopt;
    patch.planes.push_back({normal, normal.dot(corner(0))});
    patch.points.insert(patch.points.end(), piece.begin(), piece.end());
  }
  return patch;
}

/// Whether all points have at most (sign = 1) or at least (sign = -1) the planes' heights.
bool allBehind(const Patch& patch, double sign, double tolerance) {
  return std::all_of(patch.planes.begin(), patch.planes.end(), [&](const HalfSpace& plane) {
    return std::all_of(patch.points.begin(), patch.points.end(), [&](const Vector3d& p) {
      return sign * (plane.normal.dot(p) - plane.offset) <= tolerance;
    });
  });
}

/// Whether the inside test agrees that the part of the cube behind all planes is solid (`solid`) or empty,
/// and the rest the other way.
bool confirmed(const Surface& surface, const AlignedBox3d& cube, const Patch& patch, const Polyhedron& behind,
               bool solid, double tolerance) {
  Vector3d middle = Vector3d::Zero();
  double count = 0;
  const auto include = [&](const Vector3d& p) {
    middle += p;
    count += 1;
  };
  for (const Vector3d& p : patch.points) include(p);
  for (const Vector3d& corner : medial::cornersOf(cube)) {
    double height = -1;
    bool onPlane = false;
    for (const HalfSpace& plane : behind) {
      const double above = plane.normal.dot(corner) - plane.offset;
      onPlane = onPlane || std::abs(above) <= tolerance;
      height = std::max(height, above);
    }
    if (height <= 0) include(corner);
    if (!onPlane && surface.inside(corner) != ((height < 0) == solid)) return false;
  }
  middle /= count;
  const bool flat = std::any_of(behind.begin(), behind.end(), [&](const HalfSpace& plane) {
    return plane.normal.dot(middle) - plane.offset > -tolerance;
  });
  return flat || surface.inside(middle) == solid;
}

}  // namespace

std::optional<Bounds> solidOutside(const Surface& surface, const AlignedBox3d& cube,
                                   std::span<const std::uint32_t> triangles, std::span<const Ball> balls) {
  const Polyhedron sides = sidesOf(cube);
  const double tolerance = kFlat * surface.diagonal();
  double missing = 0;
  if (triangles.empty()) {
    missing = leftOver(sides, cube, balls);
  } else {
    const std::optional<Patch> patch = patchIn(surface, cube, triangles);
    if (!patch || patch->planes.empty()) return std::nullopt;
    const bool convex = allBehind(*patch, 1, tolerance);
    if (!convex && !allBehind(*patch, -1, tolerance)) return std::nullopt;
    Polyhedron behind = patch->planes;
    if (!convex) {
      for (HalfSpace& plane : behind) plane = {-plane.normal, -plane.offset};
    }
    if (!confirmed(surface, cube, *patch, behind, convex, tolerance)) return std::nullopt;
    behind.insert(behind.end(), sides.begin(), sides.end());
    const double part = leftOver(behind, cube, balls);
    missing = convex ? part : leftOver(sides, cube, balls) - part;
  }
  const double side = cube.sizes().x();
  double rounding = (kVolumeRounding * side + tolerance) * side * side;
  for (const Ball& ball : balls) rounding += kVolumeRounding * ball.radius * ball.radius * ball.radius;
  return Bounds{std::max(0.0, missing - rounding),
                std::min(cube.volume(), std::max(0.0, missing) + rounding)};
}

}  // namespace spheretree::builders
