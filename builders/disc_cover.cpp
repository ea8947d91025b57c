// SPDX-License-Identifier: GPL-3.0-or-later
//
// Area of a triangle outside a union of balls.
//
// Reference: F. Avis, B. Bhattacharya, H. Imai, "Computing the volume of the union of spheres", The Visual
// Computer 3, 1988, one dimension lower.
//
// Summary: balls meet the triangle's plane in discs. The power diagram of the discs cuts their union into
// pieces, each a disc inside a convex polygon: the triangle clipped by the bisectors with the other discs.
// Such a piece is a signed sum over the polygon's edges of triangles and sectors. The same thing as
// union_volume.cpp in the plane.

#include "builders/disc_cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "builders/plane_polygon.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using medial::Ball;
using medial::SurfaceCell;

/// A disc that sticks out of another one by less than this fraction of the radius is left away: mirrored
/// balls give the same disc but for rounding.
constexpr double kSameDisc = 1e-13;
/// Rounding of a piece, and what kSameDisc drops, as a fraction of its disc's squared radius.
constexpr double kAreaRounding = 1e-12;

struct Disc {
  Vector2d center;
  double radius;
};

/// Area of disc and right-angled triangle (centre, m, v) in common; the right angle is at m, |centre m| = p,
/// |m v| = t. Nothing negative.
double cutTriangle(double radius, double p, double t) {
  const double angle = std::atan2(t, p);
  if (p >= radius) return radius * radius * angle / 2;
  const double chord = std::sqrt((radius - p) * (radius + p));
  if (t <= chord) return p * t / 2;
  return (p * chord + radius * radius * (angle - std::atan2(chord, p))) / 2;
}

/// Area of polygon and disc in common; the polygon is relative to the disc's centre.
double commonArea(const PlanePolygon& polygon, double radius) {
  return polygon.sumOverRightTriangles([&](double p, double t) { return cutTriangle(radius, p, t); });
}

/// The triangle in its own plane, counter-clockwise, the first corner at the origin.
struct FlatTriangle {
  Vector3d origin, first, second, normal;  // an orthonormal frame
  std::array<Vector2d, 3> corner;

  explicit FlatTriangle(const SurfaceCell& cell) : origin(cell[0]) {
    const Vector3d a = cell[1] - cell[0];
    const Vector3d b = cell[2] - cell[0];
    first = a.normalized();
    normal = a.cross(b).normalized();
    second = normal.cross(first);
    corner = {Vector2d::Zero(), Vector2d(a.norm(), 0), Vector2d(first.dot(b), second.dot(b))};
  }

  /// As a polygon relative to `center`.
  [[nodiscard]] std::array<PlanePolygon::Edge, 3> around(const Vector2d& center) const {
    std::array<PlanePolygon::Edge, 3> edges;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector2d start = corner[k] - center;
      const Vector2d along = (corner[(k + 1) % 3] - corner[k]).normalized();
      const Vector2d outward(along.y(), -along.x());
      edges[k] = {{outward, outward.dot(start)}, start};
    }
    return edges;
  }
};

/// The discs in which the balls meet the plane, largest first, without those inside another one.
std::vector<Disc> discsIn(const FlatTriangle& triangle, std::span<const Ball> balls,
                          std::span<const std::uint32_t> candidates) {
  std::vector<Disc> discs;
  for (const std::uint32_t i : candidates) {
    const Vector3d to = balls[i].center - triangle.origin;
    const double height = std::abs(triangle.normal.dot(to));
    if (height >= balls[i].radius) continue;
    discs.push_back({Vector2d(triangle.first.dot(to), triangle.second.dot(to)),
                     std::sqrt((balls[i].radius - height) * (balls[i].radius + height))});
  }
  std::stable_sort(discs.begin(), discs.end(),
                   [](const Disc& a, const Disc& b) { return a.radius > b.radius; });
  std::size_t kept = 0;
  for (const Disc& disc : discs) {
    bool hidden = false;
    for (std::size_t k = 0; k < kept && !hidden; ++k) {
      const double room = discs[k].radius * (1 + kSameDisc) - disc.radius;
      hidden = (disc.center - discs[k].center).squaredNorm() <= room * room;
    }
    if (!hidden) discs[kept++] = disc;
  }
  discs.resize(kept);
  return discs;
}

}  // namespace

Bounds areaOutside(const SurfaceCell& triangle, std::span<const Ball> balls,
                   std::span<const std::uint32_t> candidates) {
  const double area = medial::areaOf(triangle);
  if (!(area > 0)) return {};
  const FlatTriangle flat(triangle);
  const std::vector<Disc> discs = discsIn(flat, balls, candidates);
  PlanePolygon polygon;
  double outside = area;
  double rounding = kAreaRounding * area;
  for (const Disc& disc : discs) {
    polygon.assign(flat.around(disc.center));
    for (const Disc& other : discs) {
      if (&other == &disc || polygon.empty()) continue;
      const Vector2d apart = other.center - disc.center;
      const double distance = apart.norm();
      if (distance >= disc.radius + other.radius) continue;
      const double radii = (disc.radius - other.radius) * (disc.radius + other.radius);
      polygon.clip({apart / distance, (distance + radii / distance) / 2});
    }
    if (polygon.empty()) continue;
    outside -= commonArea(polygon, disc.radius);
    rounding += kAreaRounding * disc.radius * disc.radius;
  }
  return {std::clamp(outside - rounding, 0.0, area), std::clamp(outside + rounding, 0.0, area)};
}

}  // namespace spheretree::builders
