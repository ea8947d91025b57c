// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volume of a union of balls by its power diagram.
//
// Reference: H. Edelsbrunner, "The union of balls and its dual shape", Discrete & Computational Geometry 13,
// 1995: the cells of the power diagram cut the union into disjoint pieces, each a ball cut by a polyhedron.
//
// Summary: the polyhedron of a ball is bounded by the radical planes with the balls that overlap it (and by a
// box around the ball, so that it is finite). Its pieces are cones from the ball's centre to its faces, each
// cut by the ball, signed by the side of the face on which the centre lies. A face is a square clipped by all
// other planes; each of its edges gives two right-angled triangles at the foot of the centre's perpendicular,
// and the cone over a right-angled triangle has a closed form (cutCone). Signed sums over planes and edges
// are continuous in the input, so coplanar, cospherical and touching balls need no special cases.

#include "builders/union_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "builders/plane_polygon.hpp"

namespace spheretree::builders {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using medial::Ball;

// Everything about one ball is computed in a copy moved to the origin and scaled to radius 1.

/// Half the side of the box that makes every polyhedron finite. Anything above 1 gives the same volume; well
/// above keeps its faces away from the radical planes, which all have |offset| < 1.
constexpr double kBoxHalfSide = 1.25;
/// Half the side of the square that a face is cut from: the box and its projections onto planes fit inside.
constexpr double kSquareHalfSide = 4;

/// Planes that differ by less are one: above the rounding of a normal (a few 1e-16), and too little to show.
constexpr double kSamePlane = 1e-14;

bool holdsBall(const Ball& outer, const Ball& inner) {
  const double slack = outer.radius - inner.radius;
  return slack >= 0 && (inner.center - outer.center).squaredNorm() <= slack * slack;
}

/// Volume of {x in the unit ball, x on a ray from the origin through T}, cut at T. T is the right-angled
/// triangle (f, m, v) in a plane at distance h from the origin: f the foot of the perpendicular, |fm| = p,
/// |mv| = t, the right angle at m. Nothing negative.
///
/// The integral of min(1, distance)^3 / 3 over the solid angle h rho drho dtheta / (h^2 + rho^2)^(3/2).
/// `beyond(t)` is angle - (solid angle of T); arc tangents keep it exact near right angles.
double cutCone(double h, double p, double t) {
  const auto beyond = [&](double reach) {
    return std::atan2(h * reach, p * std::sqrt(h * h + p * p + reach * reach));
  };
  const double angle = std::atan2(t, p);
  if (h >= 1) return (angle - beyond(t)) / 3;
  const double discSquared = 1 - h * h;  // the ball cuts the plane in a disc around f
  if (p * p >= discSquared) return h * angle * discSquared / 6 + (angle * h - beyond(t)) / 3;
  const double chord = std::sqrt(discSquared - p * p);
  if (t <= chord) return h * p * t / 6;
  const double rest = angle - std::atan2(chord, p);
  return h * (p * chord + rest * discSquared) / 6 + (rest * h - (beyond(t) - beyond(chord))) / 3;
}

/// The volume of the unit ball inside the cone from the origin to a face. `polygon` is relative to the foot
/// of the perpendicular, at distance |offset|; the sign is that of the offset.
double faceVolume(const PlanePolygon& polygon, double offset) {
  const double h = std::abs(offset);
  return std::copysign(1.0, offset) *
         polygon.sumOverRightTriangles([&](double p, double t) { return cutCone(h, p, t); });
}

/// The trace of half-space `b` in the boundary plane of `a`, relative to the foot of a's perpendicular: a
/// unit normal in that plane, and its offset. For parallel planes the normal is 0 and the offset says all or
/// nothing.
///
/// Both planes of a pair compute their common line from the same differences (normals, offsets), which are
/// exact for nearly equal planes: the faces then meet in one line however small the angle is, and an error in
/// its position moves volume from one face to the other without losing any.
HalfSpace trace(const HalfSpace& a, const HalfSpace& b) {
  const bool sameSide = a.normal.dot(b.normal) > 0;
  const Vector3d turn = sameSide ? Vector3d(b.normal - a.normal) : Vector3d(b.normal + a.normal);
  const double room = sameSide ? b.offset - a.offset : b.offset + a.offset;
  const double lean = a.normal.dot(turn);  // also what b's normal misses to unit length
  const Vector3d inPlane = turn - lean * a.normal;
  const double sine = inPlane.norm();
  const double offset = room - lean * a.offset;
  if (sine == 0) return {Vector3d::Zero(), offset >= 0 ? 1.0 : -1.0};
  return {inPlane / sine, offset / sine};
}

/// Sorts by offset and drops planes that equal an earlier one but for rounding.
void sortPlanes(std::vector<HalfSpace>& planes) {
  std::stable_sort(planes.begin(), planes.end(),
                   [](const HalfSpace& a, const HalfSpace& b) { return a.offset < b.offset; });
  std::size_t kept = 0;
  for (const HalfSpace& plane : planes) {
    bool repeated = false;
    for (std::size_t k = kept; k-- > 0 && plane.offset - planes[k].offset <= kSamePlane && !repeated;) {
      repeated = (plane.normal - planes[k].normal).squaredNorm() <= kSamePlane * kSamePlane;
    }
    if (!repeated) planes[kept++] = plane;
  }
  planes.resize(kept);
}

/// The unit ball inside the intersection of half-spaces and the box.
class UnitPiece {
 public:
  /// `planes` has room for the six sides of the box, which it gets here.
  double volume(std::vector<HalfSpace>& planes) {
    // The nearest planes cut most: most of the others then lose their whole face after a few cuts.
    sortPlanes(planes);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      planes.push_back({Vector3d::Unit(axis), kBoxHalfSide});
      planes.push_back({-Vector3d::Unit(axis), kBoxHalfSide});
    }
    double sum = 0;
    for (std::size_t face = 0; face < planes.size(); ++face) {
      if (planes[face].offset == 0) continue;  // a flat cone
      makeFace(planes, face);
      if (!polygon_.empty()) sum += faceVolume(polygon_, planes[face].offset);
    }
    return sum;
  }

 private:
  void makeFace(const std::vector<HalfSpace>& planes, std::size_t face) {
    constexpr double s = kSquareHalfSide;
    static const std::array<PlanePolygon::Edge, 4> kSquare{{{{-Vector2d::UnitY(), s}, {-s, -s}},
                                                            {{Vector2d::UnitX(), s}, {s, -s}},
                                                            {{Vector2d::UnitY(), s}, {s, s}},
                                                            {{-Vector2d::UnitX(), s}, {-s, s}}}};
    polygon_.assign(kSquare);
    const HalfSpace& plane = planes[face];
    const Vector3d first = plane.normal.unitOrthogonal();
    const Vector3d second = plane.normal.cross(first);
    for (std::size_t other = 0; other < planes.size() && !polygon_.empty(); ++other) {
      if (other == face) continue;
      const HalfSpace cut = trace(plane, planes[other]);
      polygon_.clip({Vector2d(first.dot(cut.normal), second.dot(cut.normal)), cut.offset});
    }
  }

  PlanePolygon polygon_;
};

/// For each ball the others that share a point with it, ascending. Balls inside others are marked and have
/// no neighbours; of equal ones the first is kept.
struct Overlaps {
  std::vector<std::vector<std::uint32_t>> neighbours;
  std::vector<char> redundant;
};

Overlaps findOverlaps(std::span<const Ball> balls) {
  Overlaps result{std::vector<std::vector<std::uint32_t>>(balls.size()), std::vector<char>(balls.size(), 0)};
  std::vector<std::uint32_t> order(balls.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto low = [&](std::uint32_t i) { return balls[i].center.x() - balls[i].radius; };
  const auto high = [&](std::uint32_t i) { return balls[i].center.x() + balls[i].radius; };
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return low(a) < low(b); });
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (std::size_t at = 0; at < order.size(); ++at) {
    for (std::size_t after = at + 1; after < order.size() && low(order[after]) <= high(order[at]); ++after) {
      const std::uint32_t i = std::min(order[at], order[after]);
      const std::uint32_t j = std::max(order[at], order[after]);
      const double reach = balls[i].radius + balls[j].radius;
      if ((balls[i].center - balls[j].center).squaredNorm() > reach * reach) continue;
      if (holdsBall(balls[i], balls[j])) {
        result.redundant[j] = 1;
      } else if (holdsBall(balls[j], balls[i])) {
        result.redundant[i] = 1;
      } else {
        pairs.push_back({i, j});
      }
    }
  }
  for (const auto& [i, j] : pairs) {
    if (result.redundant[i] != 0 || result.redundant[j] != 0) continue;
    result.neighbours[i].push_back(j);
    result.neighbours[j].push_back(i);
  }
  for (auto& list : result.neighbours) std::sort(list.begin(), list.end());
  return result;
}

/// The points whose power distance to `ball` is at most that to `other`, in the ball's own frame.
HalfSpace radicalHalfSpace(const Ball& ball, const Ball& other) {
  const Vector3d apart = other.center - ball.center;
  const double distance = apart.norm();
  const double radii = (ball.radius - other.radius) * (ball.radius + other.radius);
  return {apart / distance, (distance + radii / distance) / 2 / ball.radius};
}

}  // namespace

double unionVolume(std::span<const Ball> balls) {
  return unionVolumeIn(balls, {});
}

double unionVolumeIn(std::span<const Ball> balls, std::span<const HalfSpace> halfSpaces) {
  const Overlaps overlaps = findOverlaps(balls);
  UnitPiece piece;
  std::vector<HalfSpace> planes;
  double sum = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (overlaps.redundant[i] != 0 || !(balls[i].radius > 0)) continue;
    planes.clear();
    bool cutAway = false;
    const auto cut = [&](const HalfSpace& side) {
      cutAway = cutAway || side.offset <= -1;
      if (side.offset < 1) planes.push_back(side);
    };
    for (const std::uint32_t j : overlaps.neighbours[i]) cut(radicalHalfSpace(balls[i], balls[j]));
    for (const HalfSpace& side : halfSpaces) {
      cut({side.normal, (side.offset - side.normal.dot(balls[i].center)) / balls[i].radius});
    }
    if (cutAway) continue;
    const double unit = planes.empty() ? 4 * std::numbers::pi / 3 : piece.volume(planes);
    sum += unit * balls[i].radius * balls[i].radius * balls[i].radius;
  }
  return sum;
}

}  // namespace spheretree::builders
