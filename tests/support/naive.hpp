// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What certificates and queries are compared with: no hierarchy, no predicate, no cleverness, short enough to
// be right by looking at it. Everything is a loop over all triangles or all balls.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <queue>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <spheretree/sphere_tree.hpp>

#include "medial/ball.hpp"
#include "medial/triangle_mesh.hpp"

namespace spheretree::test::naive {

using Corners = std::array<Eigen::Vector3d, 3>;

/// Of a midpoint and a distance, relative to the coordinates.
inline constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline Corners cornersOf(const medial::TriangleMesh& mesh, std::size_t triangle) {
  return {mesh.corner(triangle, 0), mesh.corner(triangle, 1), mesh.corner(triangle, 2)};
}

// --- points against triangles ---

inline double distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  const double squared = d.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(d) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

inline double distance(const Eigen::Vector3d& p, const Corners& t) {
  const auto& [a, b, c] = t;
  const double edges = std::min({distance(p, a, b), distance(p, b, c), distance(p, c, a)});
  Eigen::Vector3d n = (b - a).cross(c - a);
  if (!(n.squaredNorm() > 0)) return edges;  // isZero() of Eigen takes tiny triangles for flat ones
  n.normalize();
  const Eigen::Vector3d foot = p - (p - a).dot(n) * n;
  const bool inside = (b - a).cross(foot - a).dot(n) >= 0 && (c - b).cross(foot - b).dot(n) >= 0 &&
                      (a - c).cross(foot - c).dot(n) >= 0;
  return inside ? std::abs((p - a).dot(n)) : edges;
}

/// Of the surface, unsigned.
inline double distance(const Eigen::Vector3d& p, const medial::TriangleMesh& mesh) {
  double least = kInfinity;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    least = std::min(least, distance(p, cornersOf(mesh, t)));
  return least;
}

/// Winding number by solid angles (Van Oosterom, Strackee 1983).
inline double windingNumber(const medial::TriangleMesh& mesh, const Eigen::Vector3d& p) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d a = mesh.corner(t, 0) - p;
    const Eigen::Vector3d b = mesh.corner(t, 1) - p;
    const Eigen::Vector3d c = mesh.corner(t, 2) - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    const double numerator = a.dot(b.cross(c));
    const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    sum += std::atan2(numerator, denominator);
  }
  return sum / (2 * std::numbers::pi);
}

/// Distance to the surface; positive inside, negative outside.
inline double depth(const medial::TriangleMesh& mesh, const Eigen::Vector3d& p) {
  const double unsignedDistance = distance(p, mesh);
  return std::lround(windingNumber(mesh, p)) > 0 ? unsignedDistance : -unsignedDistance;
}

// --- balls ---

inline medial::Ball ballOf(const Sphere& sphere) {
  return {{static_cast<double>(sphere.center.x), static_cast<double>(sphere.center.y),
           static_cast<double>(sphere.center.z)},
          static_cast<double>(sphere.radius)};
}

/// How far outside the ball a point is; negative inside.
inline double outside(const medial::Ball& ball, const Eigen::Vector3d& p) {
  return (p - ball.center).norm() - ball.radius;
}

inline double outside(std::span<const medial::Ball> balls, const Eigen::Vector3d& p) {
  double least = kInfinity;
  for (const medial::Ball& ball : balls) least = std::min(least, outside(ball, p));
  return least;
}

/// Farther outside the ball no point of the triangle is: the distance to a ball is convex.
inline double outside(const medial::Ball& ball, const Corners& t) {
  return std::max({outside(ball, t[0]), outside(ball, t[1]), outside(ball, t[2])});
}

/// The four similar pieces of a triangle.
inline std::array<Corners, 4> quarters(const Corners& t) {
  const Eigen::Vector3d ab = (t[0] + t[1]) / 2;
  const Eigen::Vector3d bc = (t[1] + t[2]) / 2;
  const Eigen::Vector3d ca = (t[2] + t[0]) / 2;
  return {Corners{t[0], ab, ca}, Corners{ab, t[1], bc}, Corners{ca, bc, t[2]}, Corners{ab, bc, ca}};
}

struct Bracket {
  double lower = 0;
  double upper = 0;
  std::size_t pieces = 0;  ///< examined
};

/// The largest distance of a surface point to the union of the balls, 0 when they cover; by quartering, worst
/// piece first, until the bracket is narrower than `gap` or `mostPieces` were looked at.
inline Bracket uncoveredDistance(const medial::TriangleMesh& mesh, std::span<const medial::Ball> balls,
                                 double gap, std::size_t mostPieces) {
  struct Piece {
    Corners corners;
    double upper = 0;
    bool operator<(const Piece& other) const { return upper < other.upper; }
  };
  Bracket bracket;
  std::priority_queue<Piece> open;
  const auto examine = [&](const Corners& corners) {
    ++bracket.pieces;
    for (const Eigen::Vector3d& p : corners) bracket.lower = std::max(bracket.lower, outside(balls, p));
    double upper = kInfinity;
    for (const medial::Ball& ball : balls) upper = std::min(upper, outside(ball, corners));
    if (upper > 0) open.push({corners, upper});
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) examine(cornersOf(mesh, t));
  while (!open.empty() && open.top().upper > bracket.lower + gap && bracket.pieces < mostPieces) {
    const Corners worst = open.top().corners;
    open.pop();
    for (const Corners& piece : quarters(worst)) examine(piece);
  }
  bracket.upper = open.empty() ? 0 : std::max(bracket.lower, open.top().upper);
  return bracket;
}

/// How far the ball sticks out of the solid, by cutting its cube into eighths, most promising first: a
/// distance changes by at most the way one goes.
inline Bracket overhang(const medial::TriangleMesh& mesh, const medial::Ball& ball, double gap,
                        std::size_t mostPieces) {
  struct Cube {
    Eigen::Vector3d center;
    double half = 0;
    double upper = 0;
    bool operator<(const Cube& other) const { return upper < other.upper; }
  };
  Bracket bracket;
  std::priority_queue<Cube> open;
  const auto examine = [&](const Eigen::Vector3d& center, double half) {
    const Eigen::Vector3d radial = center - ball.center;
    const double reach = std::sqrt(3.0) * half;
    if (radial.norm() - reach > ball.radius) return;  // misses the ball
    const bool within = radial.norm() <= ball.radius;
    const Eigen::Vector3d probe =
        within ? center : Eigen::Vector3d(ball.center + ball.radius * radial.normalized());
    ++bracket.pieces;
    const double out = -depth(mesh, probe);
    bracket.lower = std::max(bracket.lower, out);
    if (out + reach > 0) open.push({center, half, out + reach});
  };
  examine(ball.center, ball.radius);
  while (!open.empty() && open.top().upper > bracket.lower + gap && bracket.pieces < mostPieces) {
    const Cube best = open.top();
    open.pop();
    for (unsigned k = 0; k < 8; ++k) {
      const Eigen::Vector3d octant((k & 1U) != 0 ? 1 : -1, (k & 2U) != 0 ? 1 : -1, (k & 4U) != 0 ? 1 : -1);
      examine(best.center + best.half / 2 * octant, best.half / 2);
    }
  }
  bracket.upper = open.empty() ? bracket.lower : std::max(bracket.lower, open.top().upper);
  return bracket;
}

// --- chains ---

enum class Verdict : std::uint8_t { Proved, Refuted, Undecided };

/// Whether a chain of balls below `node`, that one included, holds all the points down to the last level.
inline bool chainHolds(const SphereTree& tree, const Node& node, std::span<const Eigen::Vector3d> points,
                       std::size_t levelsBelow, double noise = 0) {
  const medial::Ball ball = ballOf(node.ball);
  for (const Eigen::Vector3d& p : points) {
    if (outside(ball, p) > noise) return false;
  }
  if (levelsBelow == 0 || node.childCount == 0) return true;  // without children it stands for itself
  for (const Node& child : tree.children(node)) {
    if (chainHolds(tree, child, points, levelsBelow - 1, noise)) return true;
  }
  return false;
}

/// Whether every point of the surface lies in a chain, by quartering; undecided after so many pieces. Refuted
/// by a point that is outside by more than its own rounding.
inline Verdict chainsCover(const medial::TriangleMesh& mesh, const SphereTree& tree, std::size_t mostPieces) {
  std::vector<Corners> open;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) open.push_back(cornersOf(mesh, t));
  const std::size_t below = tree.levelCount() - 1;
  double noise = 0;
  for (const Corners& corners : open) {
    for (const Eigen::Vector3d& p : corners) noise = std::max(noise, kRounding * p.cwiseAbs().maxCoeff());
  }
  for (std::size_t pieces = 0; !open.empty(); ++pieces) {
    if (pieces == mostPieces) return Verdict::Undecided;
    const Corners piece = open.back();
    open.pop_back();
    if (chainHolds(tree, tree.root(), piece, below)) continue;
    for (const Eigen::Vector3d& p : piece) {
      if (!chainHolds(tree, tree.root(), std::span(&p, 1), below, noise)) return Verdict::Refuted;
    }
    for (const Corners& quarter : quarters(piece)) open.push_back(quarter);
  }
  return Verdict::Proved;
}

// --- triangles against triangles ---

inline double distanceOfSegments(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                                 const Eigen::Vector3d& d) {
  // Where no end is nearest, the common perpendicular meets both.
  double least = std::min({distance(a, c, d), distance(b, c, d), distance(c, a, b), distance(d, a, b)});
  const Eigen::Vector3d u = b - a;
  const Eigen::Vector3d v = d - c;
  const Eigen::Vector3d n = u.cross(v);
  const double squared = n.squaredNorm();
  if (!(squared > 0)) return least;
  const double s = (c - a).cross(v).dot(n) / squared;
  const double t = (c - a).cross(u).dot(n) / squared;
  if (s > 0 && s < 1 && t > 0 && t < 1) least = std::min(least, (a + s * u - c - t * v).norm());
  return least;
}

/// Whether the segment pierces the triangle, with its ends clearly on different sides.
inline bool pierces(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Corners& t) {
  const auto& [a, b, c] = t;
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const double before = (from - a).dot(n);
  const double behind = (to - a).dot(n);
  const double noise = 1e-12 * n.norm() * ((from - a).norm() + (to - a).norm());
  if (!(std::min(before, behind) < -noise && std::max(before, behind) > noise)) return false;
  const Eigen::Vector3d at = from + before / (before - behind) * (to - from);
  return (b - a).cross(at - a).dot(n) > 0 && (c - b).cross(at - b).dot(n) > 0 &&
         (a - c).cross(at - c).dot(n) > 0;
}

/// Of two surfaces; 0 when they cross.
inline double distance(const medial::TriangleMesh& first, const medial::TriangleMesh& second) {
  double least = kInfinity;
  for (std::size_t i = 0; i < first.triangles.size(); ++i) {
    const Corners s = cornersOf(first, i);
    for (std::size_t j = 0; j < second.triangles.size(); ++j) {
      const Corners t = cornersOf(second, j);
      for (std::size_t k = 0; k < 3; ++k) {
        if (pierces(s[k], s[(k + 1) % 3], t) || pierces(t[k], t[(k + 1) % 3], s)) return 0;
        least = std::min({least, distance(s[k], t), distance(t[k], s)});
        for (std::size_t l = 0; l < 3; ++l)
          least = std::min(least, distanceOfSegments(s[k], s[(k + 1) % 3], t[l], t[(l + 1) % 3]));
      }
    }
  }
  return least;
}

/// Of two solids: also 0 when one holds a corner of the other.
inline double distanceOfSolids(const medial::TriangleMesh& first, const medial::TriangleMesh& second) {
  const auto swallows = [](const medial::TriangleMesh& solid, const medial::TriangleMesh& other) {
    return std::any_of(other.vertices.begin(), other.vertices.end(), [&](const Eigen::Vector3d& vertex) {
      return std::lround(windingNumber(solid, vertex)) > 0;
    });
  };
  return swallows(first, second) || swallows(second, first) ? 0 : distance(first, second);
}

}  // namespace spheretree::test::naive
