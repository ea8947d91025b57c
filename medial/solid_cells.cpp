// SPDX-License-Identifier: GPL-3.0-or-later
//
// The solid inside a cube, as points.
//
// Reference: I. Sutherland, G. Hodgman, "Reentrant polygon clipping", Communications of the ACM 17, 1974.
//
// Summary: each triangle is clipped by the six sides of the cube in turn; what is left of it has its corners
// among the points. An edge is cut from its lexicographically smaller end, so that the two triangles of an
// edge leave the same bits and equal points can be found by comparison.

#include "medial/solid_cells.hpp"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace spheretree::medial {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// How much larger than the surface's bounds the root cube is: keeps flat sides of a solid, which often are
/// what its bounds are made of, off the sides of cubes.
constexpr double kRootCubeGrowth = 1.0 / 128;

auto coordinates(const Vector3d& p) {
  return std::tuple(p.x(), p.y(), p.z());
}

/// A triangle cut by six planes has at most nine corners; rounding can bend it, and then each cut may leave
/// half as many again: 3, 4, 6, 9, 13, 19, 28.
constexpr std::size_t kMostCorners = 28;

struct Polygon {
  std::array<Vector3d, kMostCorners> corner;
  std::size_t size = 0;

  void add(const Vector3d& p) { corner[size++] = p; }
};

/// Where the segment meets the plane x[axis] = at. Symmetric in its ends.
Vector3d crossing(const Vector3d& p, const Vector3d& q, Eigen::Index axis, double at) {
  const bool ordered = coordinates(p) < coordinates(q);
  const Vector3d& a = ordered ? p : q;
  const Vector3d& b = ordered ? q : p;
  Vector3d result = a + ((at - a[axis]) / (b[axis] - a[axis])) * (b - a);
  result[axis] = at;
  return result;
}

/// Keeps the part with sign * x[axis] <= sign * at.
void clip(Polygon& polygon, Eigen::Index axis, double at, double sign) {
  const auto inside = [&](const Vector3d& p) { return sign * p[axis] <= sign * at; };
  const auto end = polygon.corner.begin() + static_cast<std::ptrdiff_t>(polygon.size);
  if (std::all_of(polygon.corner.begin(), end, inside)) return;
  Polygon result;
  for (std::size_t k = 0; k < polygon.size; ++k) {
    const Vector3d& here = polygon.corner[k];
    const Vector3d& next = polygon.corner[k + 1 == polygon.size ? 0 : k + 1];
    if (inside(here)) result.add(here);
    // An end on the plane is added as itself.
    if (inside(here) != inside(next) && here[axis] != at && next[axis] != at) {
      result.add(crossing(here, next, axis, at));
    }
  }
  polygon = result;
}

void clip(Polygon& polygon, const AlignedBox3d& cube) {
  for (Eigen::Index axis = 0; axis < 3 && polygon.size > 0; ++axis) {
    clip(polygon, axis, cube.max()[axis], 1);
    clip(polygon, axis, cube.min()[axis], -1);
  }
}

void sortUnique(std::vector<Vector3d>& points) {
  std::sort(points.begin(), points.end(),
            [](const Vector3d& a, const Vector3d& b) { return coordinates(a) < coordinates(b); });
  points.erase(std::unique(points.begin(), points.end()), points.end());
}

}  // namespace

std::vector<Vector3d> surfacePoints(const Surface& surface, const AlignedBox3d& cube,
                                    std::span<const std::uint32_t> nearby) {
  std::vector<Vector3d> points;
  for (const std::uint32_t triangle : nearby) {
    Polygon polygon;
    AlignedBox3d bounds;
    for (std::size_t k = 0; k < 3; ++k) {
      polygon.add(surface.mesh().corner(triangle, k));
      bounds.extend(polygon.corner[k]);
    }
    if (!cube.intersects(bounds)) continue;
    if (!cube.contains(bounds)) clip(polygon, cube);
    points.insert(points.end(), polygon.corner.begin(),
                  polygon.corner.begin() + static_cast<std::ptrdiff_t>(polygon.size));
  }
  sortUnique(points);
  return points;
}

std::vector<Vector3d> solidPoints(const Surface& surface, const AlignedBox3d& cube,
                                  std::span<const std::uint32_t> nearby) {
  std::vector<Vector3d> points = surfacePoints(surface, cube, nearby);
  const bool uniform = points.empty();
  if (uniform && !surface.inside(cube.center())) return points;
  for (const Vector3d& corner : cornersOf(cube)) {
    if (uniform || surface.inside(corner)) points.push_back(corner);
  }
  sortUnique(points);
  return points;
}

std::array<Vector3d, 8> cornersOf(const AlignedBox3d& cube) {
  std::array<Vector3d, 8> corners;
  for (unsigned k = 0; k < 8; ++k) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const bool upper = ((k >> static_cast<unsigned>(axis)) & 1U) != 0;
      corners[k][axis] = upper ? cube.max()[axis] : cube.min()[axis];
    }
  }
  return corners;
}

std::array<AlignedBox3d, 8> octants(const AlignedBox3d& cube) {
  const Vector3d middle = 0.5 * cube.min() + 0.5 * cube.max();
  std::array<AlignedBox3d, 8> result;
  for (unsigned k = 0; k < 8; ++k) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const bool upper = ((k >> static_cast<unsigned>(axis)) & 1U) != 0;
      result[k].min()[axis] = upper ? middle[axis] : cube.min()[axis];
      result[k].max()[axis] = upper ? cube.max()[axis] : middle[axis];
    }
  }
  return result;
}

AlignedBox3d solidRootCube(const Surface& surface) {
  const double half = surface.bounds().sizes().maxCoeff() / 2 * (1 + kRootCubeGrowth);
  const Vector3d center = surface.bounds().center();
  return {center.array() - half, center.array() + half};
}

}  // namespace spheretree::medial
